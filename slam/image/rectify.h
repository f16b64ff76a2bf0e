#pragma once
// Rectification: from the fisheye frame to the level pinhole image of the paper (II-A, IV).
//
//   (X, Y, Z) = ((u - c) / f, (v - c) / f, 1)        ray of rectified pixel (u, v), robot axes
//   fisheye pixel = project(R_base_camera^T (X, Y, Z))
//
// Lens, tilt and mounting's yaw end in one lookup table, made once. The result is aligned to the
// robot: u grows forward (x), v grows left (y). Looking up, that is a proper rotation: nothing is
// mirrored. The camera's lever arm is not in the image; the filter knows it.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "platform/base/arena.h"
#include "slam/capacity.h"
#include "slam/image/image.h"
#include "slam/kernels/image/image_kernels.h"
#include "slam/robot.h"

namespace zenith {

// R_base_camera of a mount.
Eigen::Matrix3d mount_rotation(const CameraMount& mount);

// The rectified image's pinhole model. Normalised coordinates are tangents: m = (X/Z, Y/Z).
struct Pinhole {
  double focal_px = 1.0;
  double centre_px = 0.5 * (kRectifiedSize - 1);

  static Pinhole from_fov(double fov_rad);
  Eigen::Vector2d normalise(double u_px, double v_px) const {
    return {(u_px - centre_px) / focal_px, (v_px - centre_px) / focal_px};
  }
  Eigen::Vector2d pixel(const Eigen::Vector2d& m) const {
    return {m.x() * focal_px + centre_px, m.y() * focal_px + centre_px};
  }
};

class Rectifier {
 public:
  void layout(Arena& arena);
  void build(const Lens& lens, const CameraMount& mount, const Pinhole& pinhole);

  // Whether the frame has pixels, as many as the lens says.
  bool fits(const ImageView& frame) const {
    return frame.data != nullptr && frame.width == frame_width_ && frame.height == frame_height_ &&
           frame.stride >= frame.width;
  }
  // Reads `frame`, which fits(); another one leaves `out` as it is. Writes kRectifiedSize x
  // kRectifiedSize.
  void apply(const ImageView& frame, const MutableImageView& out) const;

  // True when the square of +-margin around the pixel lies within what the lens sees.
  bool sees(int u, int v, int margin_px) const;

 private:
  std::span<RemapEntry> table_;
  int frame_width_ = 0;
  int frame_height_ = 0;
};

}  // namespace zenith
