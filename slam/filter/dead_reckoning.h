#pragma once
// The pose by the wheels alone, from the first known travel on: continuous, and wrong without
// bound.
//
//   x' = x + u,   P' as of a PoseEstimate and a MotionIncrement (motion.h)

#include <Eigen/Core>

#include "slam/filter/motion.h"

namespace zenith {

struct Odometry {
  Pose2 T_odom_robot;                                    // odom: base_link at the first travel
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // over (x, y, theta)
  // Of the last frame's interval, in the body: m/s forward and left, rad/s.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
};

class DeadReckoning {
 public:
  // The motion of the wheels in `interval`. One that is no number, or took no time, is left out.
  void advance(const MotionIncrement& motion, Duration interval);

  const Odometry& odometry() const { return odometry_; }

 private:
  Odometry odometry_;
};

}  // namespace zenith
