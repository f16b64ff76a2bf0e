#include "slam/filter/dead_reckoning.h"

#include <cmath>

namespace zenith {

void DeadReckoning::advance(const Wheels& wheels, Time stamp, const WheelTravel& total,
                            const MotionNoise& noise) {
  const WheelTravel travel = {total.left_m - last_.left_m, total.right_m - last_.right_m};
  const double interval_s = (stamp - last_stamp_).seconds();
  const bool first = !begun_;
  begun_ = true;
  last_ = total;
  last_stamp_ = stamp;
  if (first || interval_s <= 0.0) return;

  const MotionIncrement u = motion_increment(wheels, travel, noise);
  const Eigen::Matrix3d& Q = u.covariance;
  if (!std::isfinite(u.mean.x_m + u.mean.y_m + u.mean.theta_rad) || !Q.allFinite()) return;
  const Eigen::Vector2d moved = rotation(odometry_.T_odom_robot.theta_rad) * u.mean.position();
  odometry_.T_odom_robot = odometry_.T_odom_robot * u.mean;
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -moved.y();
  F(1, 2) = moved.x();
  Eigen::Matrix3d G = Eigen::Matrix3d::Identity();
  G.topLeftCorner<2, 2>() = rotation(odometry_.T_odom_robot.theta_rad);
  const Eigen::Matrix3d& P = odometry_.covariance;
  odometry_.covariance = (F * P * F.transpose() + G * u.covariance * G.transpose()).eval();
  odometry_.velocity = Eigen::Vector3d(u.mean.x_m, u.mean.y_m, u.mean.theta_rad) / interval_s;
  odometry_.velocity_covariance = u.covariance / (interval_s * interval_s);
}

}  // namespace zenith
