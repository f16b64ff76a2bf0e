#pragma once
// The plane's poses and transforms. Frames follow REP-103: x forward, y left, z up; angles are
// counter-clockwise in radians.

#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace zenith {

// The same angle in [-pi, pi).
inline double wrap_angle(double angle_rad) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  return angle_rad - kTwoPi * std::floor((angle_rad + std::numbers::pi) / kTwoPi);
}

inline Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

// A pose in the plane, and the rigid transform that takes that pose's coordinates into its parent:
// T_world_robot * p_in_robot = p_in_world.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;

  Eigen::Vector2d position() const { return {x_m, y_m}; }

  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const {
    const double c = std::cos(theta_rad);
    const double s = std::sin(theta_rad);
    return {x_m + c * p.x() - s * p.y(), y_m + s * p.x() + c * p.y()};
  }
  Pose2 operator*(const Pose2& b) const {
    const Eigen::Vector2d t = *this * b.position();
    return {t.x(), t.y(), wrap_angle(theta_rad + b.theta_rad)};
  }
  Pose2 inverse() const {
    const double c = std::cos(theta_rad);
    const double s = std::sin(theta_rad);
    return {-c * x_m - s * y_m, s * x_m - c * y_m, -theta_rad};
  }
};

struct PoseEstimate {
  Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // over (x, y, theta)
};

}  // namespace zenith
