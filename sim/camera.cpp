#include "sim/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zenith::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdgeSoftness_px = 3.0;
constexpr double kVignette = 0.45;  // loss at 90 degrees from the axis

// theta of theta_d by Newton's method from a near guess: neighbours in a row are near.
class InverseLens {
 public:
  explicit InverseLens(const Lens& lens) : lens_(lens) {}

  double theta(double theta_d) {
    double t = std::clamp(guess_ > 0.0 ? guess_ : theta_d, 0.0, kPi);
    for (int i = 0; i < 20; ++i) {
      const double t2 = t * t;
      const auto& k = lens_.k;
      const double slope =
          1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
      const double step = (lens_.distort(t) - theta_d) / slope;
      t -= step;
      if (std::abs(step) < 1e-12) break;
    }
    guess_ = t;
    return t;
  }

 private:
  const Lens& lens_;
  double guess_ = 0.0;
};

Eigen::Vector3d ray_of(const Lens& lens, InverseLens& inverse, double u, double v) {
  const double mx = (u - lens.cu_px) / lens.fu_px;
  const double my = (v - lens.cv_px) / lens.fv_px;
  const double theta_d = std::hypot(mx, my);
  if (theta_d < 1e-12) return {0.0, 0.0, 1.0};
  const double theta = inverse.theta(theta_d);
  const double s = std::sin(theta) / theta_d;
  return {mx * s, my * s, std::cos(theta)};
}

void store(float (&out)[3], const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

PixelRay pixel_ray(const Lens& lens, InverseLens& inverse, const Eigen::Matrix3d& R, double u,
                   double v) {
  constexpr double kStep = 0.25;
  const Eigen::Vector3d centre = ray_of(lens, inverse, u, v);
  const Eigen::Vector3d d = R * centre;
  const Eigen::Vector3d right = ray_of(lens, inverse, u + kStep, v);
  const Eigen::Vector3d left = ray_of(lens, inverse, u - kStep, v);
  const Eigen::Vector3d below = ray_of(lens, inverse, u, v + kStep);
  const Eigen::Vector3d above = ray_of(lens, inverse, u, v - kStep);
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
  const double field = 0.5 * field_deg * kPi / 180.0;
  const double limit = std::min(field, max_view_angle_deg * kPi / 180.0);
  const double rim_px = lens.distort(field) * lens.fu_px;
  const double limit_d = lens.distort(limit);
  min_slope_ = 1e9F;
  InverseLens inverse(lens);
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
      PixelRay ray = pixel_ray(lens, inverse, R, u, v);
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
