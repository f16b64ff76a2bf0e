#pragma once
// Pixels of rays and rays of pixels, for every model of a lens (slam/image/lens.h), as far from the
// axis as the model goes. Made once from a Lens: the making takes about a millisecond, for it
// follows the curve to where it folds; a call takes about as long as the formula.
//
// Where several rays would share a pixel there is neither ray nor pixel: the curve rho(theta) is
// used up to where it stops to rise.

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "slam/image/lens.h"

namespace zenith {

class LensProjection {
 public:
  // Any numbers do: a lens that is none shows nothing, limit_rad() is 0.
  explicit LensProjection(const Lens& lens);

  const Lens& lens() const { return lens_; }

  // Rays farther from the axis have no pixel.
  double limit_rad() const { return limit_rad_; }
  // Whether the curve ends at the limit because it folds back there, and not because its formula
  // knows no farther rays.
  bool folds() const { return folds_; }

  // The model's curve: focal lengths (scaramuzza: pixels) from the centre of a ray at this angle
  // from the axis, without decentring and shear. Of angles below limit_rad().
  double rho(double theta_rad) const;

  // d rho / d theta on the axis, by which a focal length has to be multiplied to be pixels a
  // radian.
  double axis_slope() const { return axis_slope_; }

  // Pixel coordinates (u, v) of a ray in the camera frame; the ray needs no unit length.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const;

  // Unit ray in the camera frame of a pixel: the inverse of project().
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& uv) const;

  // Whether the pixel lies in the image, between the centres of its outermost pixels.
  bool in_image(const Eigen::Vector2d& uv) const {
    return uv.x() >= 0.0 && uv.y() >= 0.0 && uv.x() <= lens_.width_px - 1 &&
           uv.y() <= lens_.height_px - 1;
  }

 private:
  double tangent(double theta_rad) const;
  double theta_of_rho(double rho) const;
  std::optional<Eigen::Vector2d> without_decentring(const Eigen::Vector2d& m) const;

  static constexpr std::size_t kKnots = 65;

  Lens lens_;
  double limit_rad_ = 0.0;
  double axis_slope_ = 0.0;
  bool folds_ = false;
  bool decentred_ = false;
  std::array<double, kKnots> knots_ = {};  // rho at equal steps of theta up to the limit
};

}  // namespace zenith
