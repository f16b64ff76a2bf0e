#include "slam/filter/dead_reckoning.h"

#include <cmath>

namespace zenith {

void DeadReckoning::advance(const MotionIncrement& u, Duration interval) {
  const double interval_s = interval.seconds();
  if (interval_s <= 0.0) return;
  if (!std::isfinite(u.mean.x_m + u.mean.y_m + u.mean.theta_rad) || !u.covariance.allFinite()) {
    return;
  }
  const PoseEstimate now = PoseEstimate{odometry_.T_odom_robot, odometry_.covariance} * u;
  odometry_.T_odom_robot = now.mean;
  odometry_.covariance = now.covariance;
  odometry_.velocity = Eigen::Vector3d(u.mean.x_m, u.mean.y_m, u.mean.theta_rad) / interval_s;
  odometry_.velocity_covariance = u.covariance / (interval_s * interval_s);
}

}  // namespace zenith
