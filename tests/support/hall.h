#pragma once
// A made-up ceiling in pixels, without the simulator: tiles of random grey, as a fisheye camera
// below sees them. Rays are made once.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry.h"
#include "slam/image/image.h"
#include "slam/image/lens_projection.h"
#include "slam/robot.h"

namespace zenith {

// With a small picture, so that steps are fast.
inline RobotConfig small_robot() {
  RobotConfig robot;
  robot.lens.width_px = 320;
  robot.lens.height_px = 240;
  robot.lens.fu_px = robot.lens.fv_px = 75.0;
  robot.lens.cu_px = 160.0;
  robot.lens.cv_px = 120.0;
  return robot;
}

class Hall {
 public:
  explicit Hall(const Lens& lens) : lens_(lens), pixels_(make_rays()) {}

  // The frame of a camera that stands level at `pose`; valid until the next one.
  ImageView seen_from(const Pose2& pose) {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const Eigen::Vector2d at = pose * rays_[i];
      const auto column = static_cast<long>(std::floor(at.x() / kTile_m));
      const auto row = static_cast<long>(std::floor(at.y() / kTile_m));
      const auto tile = static_cast<std::uint64_t>(column * 73856093L ^ row * 19349663L);
      pixels_[i] = static_cast<std::uint8_t>((tile * 0x9E3779B97F4A7C15U) >> 56U);
    }
    return {pixels_.data(), lens_.width_px, lens_.height_px, lens_.width_px};
  }

 private:
  static constexpr double kCeiling_m = 2.4;  // above the camera
  static constexpr double kTile_m = 0.23;

  std::size_t make_rays() {
    const LensProjection projection(lens_);
    for (int v = 0; v < lens_.height_px; ++v) {
      for (int u = 0; u < lens_.width_px; ++u) {
        const Eigen::Vector3d ray = projection.unproject({u, v}).value_or(Eigen::Vector3d::UnitX());
        rays_.push_back(ray.head<2>() * kCeiling_m / std::max(ray.z(), 0.05));
      }
    }
    return rays_.size();
  }

  Lens lens_;
  std::vector<Eigen::Vector2d> rays_;  // where they meet the ceiling
  std::vector<std::uint8_t> pixels_;
};

}  // namespace zenith
