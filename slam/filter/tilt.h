#pragma once
// What is left of the camera's tilt after calibration, estimated while driving.
//
// A camera that leans 0.05 degrees more than its calibration says sees the ceiling a little stretched
// ahead and a little squeezed behind; carried from landmark to landmark that bends the scale of the
// map by a percent in 20 m. The tilt tau = (forward, left), radians, moves an observation by
//
//   z_true = z_seen + (I + z z^T) tau
//
// Method: the two-stage Kalman filter (Friedland, "Treatment of bias in recursive filtering", IEEE
// Trans. AC 14, 1969). The SLAM filter runs as if the tilt were right, and beside it runs how each
// estimate depends on the tilt: A = d pose / d tau for the robot and each anchor, B = d (ax, ay, rho)
// / d tau for each landmark. A residual then tells the tilt through its own sensitivity
//
//   D = -(I + z z^T) - H B - J_t A_t - J_a A_a
//
// with the frame's pose correction marginalised out. What is learned is fed back at once: poses and
// landmarks move by their sensitivity (landmarks when they are next touched, see Map::rows).

#include <Eigen/Core>

#include "slam/filter/landmark.h"

namespace zenith {

using PoseSensitivity = Eigen::Matrix<double, 3, 2>;      // of (x, y, theta)
using LandmarkSensitivity = Eigen::Matrix<double, 3, 2>;  // of (ax, ay, rho)

// (I + z z^T) tau.
Eigen::Vector2d tilt_shift(const Eigen::Vector2d& z, const Eigen::Vector2d& tau);

// One landmark's observation, linearised at one particle.
struct ObservationModel {
  Eigen::Matrix<double, 2, 3> by_landmark;  // H
  Eigen::Matrix<double, 2, 3> by_pose;      // J_t, world axes
  Eigen::Matrix<double, 2, 3> by_anchor;    // J_a, world axes
  Eigen::Matrix<double, 3, 2> gain;         // K = P H^T S^-1
};
ObservationModel linearise(const LandmarkRows& landmark, const CameraRows& camera, int particle,
                           const Eigen::Vector2d& lever_m, double noise);

Eigen::Matrix2d residual_sensitivity(const ObservationModel& model, const Eigen::Vector2d& z,
                                     const LandmarkSensitivity& B, const PoseSensitivity& A_pose,
                                     const PoseSensitivity& A_anchor);

class TiltEstimator {
 public:
  // `sigma_rad`: how wrong the calibration may be; 0 switches the estimation off.
  void reset(double sigma_rad);
  bool enabled() const { return enabled_; }

  void begin_frame(const Eigen::Matrix3d& motion_information);
  // One inlier: residual, its sensitivity to pose (body axes) and tilt, and its weight S^-1.
  void add(const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& G,
           const Eigen::Matrix2d& D, const Eigen::Matrix2d& weight);
  // How the frame's pose correction (body axes) depends on the tilt.
  PoseSensitivity pose_gain() const;
  // The frame's verdict: the step by which the tilt changed.
  Eigen::Vector2d end_frame();

  const Eigen::Vector2d& tau() const { return tau_; }
  Eigen::Matrix2d covariance() const;

 private:
  bool enabled_ = false;
  Eigen::Vector2d tau_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Identity();
  // This frame's normal equations over (tilt, pose correction).
  Eigen::Matrix2d tt_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 2, 3> tx_ = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix3d xx_ = Eigen::Matrix3d::Identity();
  Eigen::Vector2d t_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
};

}  // namespace zenith
