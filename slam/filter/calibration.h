#pragma once
// What is left of the camera's calibration error, estimated while driving: two angles of tilt and
// one of focal length.
//
// A camera that leans 0.05 degrees more than its calibration says sees the ceiling a little
// stretched ahead and a little squeezed behind; carried from landmark to landmark that bends the
// scale of the map by a percent in 20 m, and its heading when it leans sideways. With beta =
// (forward, left, focal)
//
//   z_true = z_seen + C(z) beta,   C(z) = [ I + z z^T | (1 + |z|^2) atan(|z|) / |z| z ]
//
// the first two in radians, the third relative. Method: the two-stage Kalman filter (Friedland,
// "Treatment of bias in recursive filtering", IEEE Trans. AC 14, 1969). The SLAM filter runs as if
// the calibration were right, and beside it runs how each estimate depends on it: A = d pose / d
// beta for the robot and each anchor, B = d (ax, ay, rho) / d beta for each landmark. A residual
// then tells beta through its own sensitivity
//
//   D = -C(z) - H B - J_t A_t - J_a A_a
//
// with the frame's pose correction marginalised out. What is learned is fed back at once: poses and
// landmarks move by their sensitivity (landmarks when they are next touched, see Map::rows).

#include <Eigen/Core>

#include "slam/filter/landmark.h"

namespace zenith {

using PoseSensitivity = Eigen::Matrix3d;      // of (x, y, theta)
using LandmarkSensitivity = Eigen::Matrix3d;  // of (ax, ay, rho)

// C(z).
Eigen::Matrix<double, 2, 3> calibration_effect(const Eigen::Vector2d& z);

// One landmark's observation, linearised at one particle.
struct ObservationModel {
  Eigen::Matrix<double, 2, 3> by_landmark;  // H
  Eigen::Matrix<double, 2, 3> by_pose;      // J_t, world axes
  Eigen::Matrix<double, 2, 3> by_anchor;    // J_a, world axes
  Eigen::Matrix<double, 3, 2> gain;         // K = P H^T S^-1
};
ObservationModel linearise(const LandmarkRows& landmark, const CameraRows& camera, int particle,
                           const Eigen::Vector2d& lever_m, double noise);

Eigen::Matrix<double, 2, 3> residual_sensitivity(const ObservationModel& model,
                                                 const Eigen::Vector2d& z,
                                                 const LandmarkSensitivity& B,
                                                 const PoseSensitivity& A_pose,
                                                 const PoseSensitivity& A_anchor);

class CalibrationEstimator {
 public:
  // How wrong the calibration may be; a tilt of 0 switches the estimation off.
  void reset(double tilt_sigma_rad, double focal_sigma);
  bool enabled() const { return enabled_; }
  // Learns no more; beta() stays.
  void freeze() { enabled_ = false; }

  void begin_frame(const Eigen::Matrix3d& motion_information);
  // One inlier: residual, its sensitivity to pose (body axes) and to beta, and its weight S^-1.
  void add(const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& G,
           const Eigen::Matrix<double, 2, 3>& D, const Eigen::Matrix2d& weight);
  // How the frame's pose correction (body axes) depends on beta.
  PoseSensitivity pose_gain() const;
  // The frame's verdict: the step by which beta changed.
  Eigen::Vector3d end_frame();

  const Eigen::Vector3d& beta() const { return beta_; }
  Eigen::Matrix3d covariance() const;

 private:
  bool enabled_ = false;
  Eigen::Vector3d beta_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Identity();
  // This frame's normal equations over (beta, pose correction).
  Eigen::Matrix3d bb_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d bx_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d xx_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
};

}  // namespace zenith
