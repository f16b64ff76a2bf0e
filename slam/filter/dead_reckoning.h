#pragma once
// The pose by the wheels alone, from the first known travel on: continuous, and wrong without
// bound.
//
//   x' = x + u,   P' = F P F^T + G Q G^T     (+: composition of poses, Pose2)
//
// u and Q are the motion model's mean and covariance over (forward, left, turn) in the body
// (proposal.h); F = dx'/dx, G turns the body's axes into those of the start.

#include <Eigen/Core>

#include "slam/filter/proposal.h"

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
  // `total` travel at `stamp`; stamps rise. The first call is the start. Travel between stamps that
  // do not rise, or that is no number, is left out.
  void advance(const Wheels& wheels, Time stamp, const WheelTravel& total,
               const MotionNoise& noise);

  const Odometry& odometry() const { return odometry_; }

 private:
  Odometry odometry_;
  WheelTravel last_;
  Time last_stamp_;
  bool begun_ = false;
};

}  // namespace zenith
