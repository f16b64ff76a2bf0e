#pragma once
// What is left of the camera's calibration error, estimated while driving: two angles of tilt, the
// principal point, the focal length.
//
// A camera that leans 0.05 degrees more than its calibration says sees the ceiling a little
// stretched ahead and a little squeezed behind; carried from landmark to landmark that bends the
// scale of the map by a percent in 20 m. A principal point that is off by 0.1 px bends the heading
// by a hundredth of a degree a metre. With beta = (tilt forward, tilt left, focal length, principal
// point forward, principal point left), r = |z| and e = z / r
//
//   z_true = z_seen + C(z) beta
//   C(z) = [ I + z z^T | (1 + r^2) atan(r)/r z | (1 + r^2) e e^T + r/atan(r) (I - e e^T) ]
//
// of an equidistant lens (1 + r^2 and r/atan(r) are the growth of its pixels; other lenses have
// another, slam/image/pixel_growth.h); tilt in radians, focal length relative, principal point in
// focal lengths. Tilt and principal point differ only
// across the radius, towards the rim. Method: the two-stage Kalman filter (Friedland, "Treatment of
// bias in recursive filtering", IEEE Trans. AC 14, 1969). The SLAM filter runs as if the
// calibration were right, and beside it runs how its errors depend on what the calibration has
// wrong: estimate = truth + A beta for the robot's pose and each anchor's, + B beta for each
// landmark's (ax, ay, rho). A landmark starts with B = [-C; 0]. A residual then tells beta through
// its own sensitivity
//
//   z_seen - m(estimate) = D beta + noise,   D = -C(z) - H B - J_t A_t - J_a A_a
//
// with the frame's pose correction marginalised out. What is learned is fed back at once: z moves
// by C dbeta, poses and landmarks by -A dbeta and -B dbeta (landmarks when they are next touched,
// see Map::rows).

#include <Eigen/Core>

#include "slam/filter/landmark.h"
#include "slam/image/pixel_growth.h"

namespace zenith {

inline constexpr int kCalibrationSize = 5;
using CalibrationVector = Eigen::Matrix<double, kCalibrationSize, 1>;
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationSize, kCalibrationSize>;
using PoseSensitivity = Eigen::Matrix<double, 3, kCalibrationSize>;      // of (x, y, theta)
using LandmarkSensitivity = Eigen::Matrix<double, 3, kCalibrationSize>;  // of (ax, ay, rho)
using SightSensitivity = Eigen::Matrix<double, 2, kCalibrationSize>;     // of z or m

// C(z).
SightSensitivity calibration_effect(const Eigen::Vector2d& z, const PixelGrowth& growth = {});

// B of a landmark that starts at z.
LandmarkSensitivity starting_sensitivity(const Eigen::Vector2d& z, const PixelGrowth& growth = {});

// One landmark's observation, linearised at one particle.
struct ObservationModel {
  Eigen::Matrix<double, 2, 3> by_landmark;  // H
  Eigen::Matrix<double, 2, 3> by_pose;      // J_t, world axes
  Eigen::Matrix<double, 2, 3> by_anchor;    // J_a, world axes
  Eigen::Matrix<double, 3, 2> gain;         // K = P H^T S^-1
};
ObservationModel linearise(const LandmarkRows& landmark, const CameraRows& camera, int particle,
                           const Eigen::Vector2d& lever_m, double noise);

SightSensitivity residual_sensitivity(const ObservationModel& model, const Eigen::Vector2d& z,
                                      const LandmarkSensitivity& B, const PoseSensitivity& A_pose,
                                      const PoseSensitivity& A_anchor,
                                      const PixelGrowth& growth = {});

// How wrong the calibration may be: standard deviations. One of 0 is taken as right.
struct CalibrationPrior {
  double tilt_rad = 0.0;
  double focal = 0.0;      // relative
  double principal = 0.0;  // in focal lengths
};

class CalibrationEstimator {
 public:
  // A tilt of 0 switches the estimation off.
  void reset(const CalibrationPrior& prior);
  bool enabled() const { return enabled_; }
  // Learns no more; beta() stays.
  void freeze() { enabled_ = false; }
  // A frame's step came out as no number, or absurd: beta() is as it was, and the rest is of no
  // use until restart(), which learns from the start again.
  bool broken() const { return broken_; }
  void restart();

  void begin_frame(const Eigen::Matrix3d& motion_information);
  // One inlier: residual, its sensitivity to pose (body axes) and to beta, its weight S^-1, and the
  // error that it shares with its anchor's others (depth_prior.h), which are added side by side.
  void add(int anchor, const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& G,
           const SightSensitivity& D, const Eigen::Matrix2d& weight, const Eigen::Vector2d& u);
  // All inliers were added. How the frame's pose correction (body axes) depends on beta.
  PoseSensitivity pose_gain();
  // A closing, in the body's axes: the pose by old landmarks lies at `jump` from that by recent
  // ones, which beta explains by `by_calibration`, and drift of this covariance. Counts once, with
  // the frame.
  void add_closing(const Eigen::Vector3d& jump, const PoseSensitivity& by_calibration,
                   const Eigen::Matrix3d& covariance);
  // The frame's verdict, which is owed to beta.
  void end_frame();
  // What was learned and is not yet in beta: a step that moves poses far is taken in parts.
  const CalibrationVector& owed() const { return owed_; }
  // Takes a share of it, 0 to 1, into beta; that part.
  CalibrationVector pay(double share);

  const CalibrationVector& beta() const { return beta_; }
  CalibrationMatrix covariance() const;

 private:
  bool enabled_ = false;
  CalibrationVector beta_ = CalibrationVector::Zero();
  CalibrationVector owed_ = CalibrationVector::Zero();
  CalibrationMatrix information_ = CalibrationMatrix::Identity();
  CalibrationMatrix prior_ = CalibrationMatrix::Identity();
  bool broken_ = false;
  CalibrationMatrix closing_ = CalibrationMatrix::Zero();
  CalibrationVector closing_b_ = CalibrationVector::Zero();
  // This frame's normal equations over (beta, pose correction).
  CalibrationMatrix bb_ = CalibrationMatrix::Zero();
  Eigen::Matrix<double, kCalibrationSize, 3> bx_ =
      Eigen::Matrix<double, kCalibrationSize, 3>::Zero();
  Eigen::Matrix3d xx_ = Eigen::Matrix3d::Identity();
  CalibrationVector b_ = CalibrationVector::Zero();
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  // Of one anchor: its landmarks' common error against all of these.
  void marginalise_shared();
  int anchor_ = -1;
  CalibrationVector shared_b_ = CalibrationVector::Zero();
  Eigen::Vector3d shared_x_ = Eigen::Vector3d::Zero();
  double shared_ = 0.0;
  double shared_residual_ = 0.0;
};

}  // namespace zenith
