#include "sim/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/image/lens_projection.h"

namespace zenith::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdgeSoftness_px = 3.0;
constexpr double kVignette = 0.45;  // loss at 90 degrees from the axis

// The ray of a pixel; where the lens has none, beyond its rim, the axis: it is black there.
Eigen::Vector3d ray_of(const LensProjection& projection, double u, double v) {
  return projection.unproject({u, v}).value_or(Eigen::Vector3d::UnitZ());
}

void store(float (&out)[3], const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

PixelRay pixel_ray(const LensProjection& lens, const Eigen::Matrix3d& R, double u, double v) {
  constexpr double kStep = 0.25;
  const Eigen::Vector3d centre = ray_of(lens, u, v);
  const Eigen::Vector3d d = R * centre;
  const Eigen::Vector3d right = ray_of(lens, u + kStep, v);
  const Eigen::Vector3d left = ray_of(lens, u - kStep, v);
  const Eigen::Vector3d below = ray_of(lens, u, v + kStep);
  const Eigen::Vector3d above = ray_of(lens, u, v - kStep);
  PixelRay ray;
  store(ray.d, d);
  store(ray.d_u, R * (right - left) / (2.0 * kStep));
  store(ray.d_v, R * (below - above) / (2.0 * kStep));
  const double horizontal = std::max(1e-9, std::hypot(d.x(), d.y()));
  ray.slope = static_cast<float>(d.z() / horizontal);
  const double turn = std::atan2(d.y(), d.x()) / (2.0 * kPi);
  ray.turn = static_cast<float>(turn < 0.0 ? turn + 1.0 : turn);
  return ray;
}

}  // namespace

Eigen::Matrix3d mount_rotation(const CameraMount& mount) {
  const double cr = std::cos(mount.roll_rad), sr = std::sin(mount.roll_rad);
  const double cp = std::cos(mount.pitch_rad), sp = std::sin(mount.pitch_rad);
  const double cy = std::cos(mount.yaw_rad), sy = std::sin(mount.yaw_rad);
  return (Eigen::Matrix3d() << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
          sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,                       //
          -sp, cp * sr, cp * cr)
      .finished();
}

Camera::Camera(const RobotConfig& robot, double field_deg, double max_view_angle_deg)
    : width_(robot.lens.width_px), height_(robot.lens.height_px), mount_(robot.mount) {
  const Lens& lens = robot.lens;
  const Eigen::Matrix3d R = mount_rotation(robot.mount);
  const LensProjection projection(lens);
  const double field = std::min(0.5 * field_deg * kPi / 180.0, projection.limit_rad());
  const double limit = std::min(field, max_view_angle_deg * kPi / 180.0);
  const double rim_px = projection.rho(field) * lens.fu_px;
  const double limit_d = projection.rho(limit);
  min_slope_ = 1e9F;
  spans_.resize(static_cast<std::size_t>(height_));
  for (int v = 0; v < height_; ++v) {
    PixelSpan& span = spans_[static_cast<std::size_t>(v)];
    span.start = static_cast<int>(rays_.size());
    const double my = (v - lens.cv_px) / lens.fv_px;
    const double half2 = limit_d * limit_d - my * my;
    if (half2 <= 0.0) continue;
    const double half_px = std::sqrt(half2) * lens.fu_px;
    span.first = std::max(0, static_cast<int>(std::ceil(lens.cu_px - half_px)));
    span.last = std::min(width_, static_cast<int>(std::floor(lens.cu_px + half_px)) + 1);
    for (int u = span.first; u < span.last; ++u) {
      PixelRay ray = pixel_ray(projection, R, u, v);
      const double r_px = std::hypot((u - lens.cu_px) / lens.fu_px, my) * lens.fu_px;
      const double theta = r_px / rim_px * field;
      const double q = theta / (0.5 * kPi);
      const double edge = std::clamp((rim_px - r_px) / kEdgeSoftness_px, 0.0, 1.0);
      ray.gain = static_cast<float>((1.0 - kVignette * q * q) * edge);
      min_slope_ = std::min(min_slope_, ray.slope);
      rays_.push_back(ray);
    }
  }
}

}  // namespace zenith::sim
