#include "slam/filter/calibration.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/geometry.h"

namespace zenith {
namespace {

// A corner's error lasts for many frames, so a frame tells less than its residuals say.
constexpr double kFrameWeight = 0.1;
// Of the information, forgotten with each frame: a mount that settles is followed in minutes.
constexpr double kForget = 2e-4;
// Radians, relative, focal lengths: no camera is so far from its calibration.
constexpr double kAbsurd = 0.5;

Eigen::Vector2d perpendicular(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

}  // namespace

SightSensitivity calibration_effect(const Eigen::Vector2d& z, const PixelGrowth& growth) {
  const double r = z.norm();
  const bool centre = r < 1e-6;
  const double along = growth.along(r);
  const double across = growth.across(r);
  const Eigen::Vector2d e = centre ? Eigen::Vector2d(1.0, 0.0) : Eigen::Vector2d(z / r);
  const Eigen::Matrix2d radial = e * e.transpose();
  SightSensitivity C;
  C.leftCols<2>() = Eigen::Matrix2d::Identity() + z * z.transpose();
  C.col(2) = along / across * z;
  C.rightCols<2>() = along * radial + across * (Eigen::Matrix2d::Identity() - radial);
  return C;
}

LandmarkSensitivity starting_sensitivity(const Eigen::Vector2d& z, const PixelGrowth& growth) {
  LandmarkSensitivity B = LandmarkSensitivity::Zero();
  B.topRows<2>() = -calibration_effect(z, growth);
  return B;
}

ObservationModel linearise(const LandmarkRows& l, const CameraRows& camera, int i,
                           const Eigen::Vector2d& lever_m, double noise) {
  const Eigen::Matrix2d R_t =
      (Eigen::Matrix2d() << camera.cos[i], -camera.sin[i], camera.sin[i], camera.cos[i]).finished();
  const Eigen::Matrix2d R_a =
      (Eigen::Matrix2d() << l.anchor_cos[i], -l.anchor_sin[i], l.anchor_sin[i], l.anchor_cos[i])
          .finished();
  const Eigen::Matrix2d R = R_t.transpose() * R_a;
  const Eigen::Vector2d between(l.anchor_x[i] - camera.x[i], l.anchor_y[i] - camera.y[i]);
  const Eigen::Vector2d b = R_t.transpose() * between;
  const double rho = l.rho[i];
  const Eigen::Vector2d from_anchor(l.ax[i], l.ay[i]);
  const Eigen::Vector2d m = R * from_anchor + rho * b;
  ObservationModel out;
  out.by_landmark << R, b;
  out.by_pose << -rho * R_t.transpose(), -perpendicular(m + rho * lever_m);
  out.by_anchor << rho * R_t.transpose(), perpendicular(R * (from_anchor + rho * lever_m));
  Eigen::Matrix3d P;
  P << l.pxx[i], l.pxy[i], l.pxr[i], l.pxy[i], l.pyy[i], l.pyr[i], l.pxr[i], l.pyr[i], l.prr[i];
  const Eigen::Matrix<double, 3, 2> PHt = P * out.by_landmark.transpose();
  const Eigen::Matrix2d S = out.by_landmark * PHt + noise * Eigen::Matrix2d::Identity();
  out.gain = PHt * S.inverse();
  return out;
}

SightSensitivity residual_sensitivity(const ObservationModel& model, const Eigen::Vector2d& z,
                                      const LandmarkSensitivity& B, const PoseSensitivity& A_pose,
                                      const PoseSensitivity& A_anchor, const PixelGrowth& growth) {
  return -calibration_effect(z, growth) - model.by_landmark * B - model.by_pose * A_pose -
         model.by_anchor * A_anchor;
}

void CalibrationEstimator::reset(const CalibrationPrior& prior) {
  enabled_ = prior.tilt_rad > 0.0;
  beta_.setZero();
  closing_.setZero();
  closing_b_.setZero();
  owed_.setZero();
  CalibrationVector sigma;
  sigma << prior.tilt_rad, prior.tilt_rad, prior.focal, prior.principal, prior.principal;
  information_.setIdentity();
  if (enabled_) information_ = sigma.cwiseMax(1e-6).cwiseAbs2().cwiseInverse().asDiagonal();
  prior_ = information_;
  broken_ = false;
}

void CalibrationEstimator::restart() {
  information_ = prior_;
  owed_.setZero();
  broken_ = false;
  closing_.setZero();
  closing_b_.setZero();
}

void CalibrationEstimator::begin_frame(const Eigen::Matrix3d& motion_information) {
  bb_.setZero();
  bx_.setZero();
  xx_ = motion_information;
  b_.setZero();
  x_.setZero();
  anchor_ = -1;
  shared_b_.setZero();
  shared_x_.setZero();
  shared_ = shared_residual_ = 0.0;
}

void CalibrationEstimator::add(int anchor, const Eigen::Vector2d& seen,
                               const Eigen::Matrix<double, 2, 3>& G, const SightSensitivity& D,
                               const Eigen::Matrix2d& weight, const Eigen::Vector2d& u) {
  const Eigen::Vector2d residual = seen - D * owed_;
  if (anchor != anchor_) marginalise_shared();
  anchor_ = anchor;
  bb_ += D.transpose() * weight * D;
  bx_ += D.transpose() * weight * G;
  xx_ += G.transpose() * weight * G;
  b_ += D.transpose() * weight * residual;
  x_ += G.transpose() * weight * residual;
  const Eigen::Vector2d Wu = weight * u;
  shared_b_ += D.transpose() * Wu;
  shared_x_ += G.transpose() * Wu;
  shared_ += Wu.dot(u);
  shared_residual_ += Wu.dot(residual);
}

void CalibrationEstimator::marginalise_shared() {
  const double variance = 1.0 / (1.0 + shared_);
  bb_ -= variance * shared_b_ * shared_b_.transpose();
  bx_ -= variance * shared_b_ * shared_x_.transpose();
  xx_ -= variance * shared_x_ * shared_x_.transpose();
  b_ -= variance * shared_residual_ * shared_b_;
  x_ -= variance * shared_residual_ * shared_x_;
  anchor_ = -1;
  shared_b_.setZero();
  shared_x_.setZero();
  shared_ = shared_residual_ = 0.0;
}

PoseSensitivity CalibrationEstimator::pose_gain() {
  marginalise_shared();
  return xx_.llt().solve(bx_.transpose());
}

void CalibrationEstimator::add_closing(const Eigen::Vector3d& jump,
                                       const PoseSensitivity& by_calibration,
                                       const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  closing_ += by_calibration.transpose() * llt.solve(by_calibration);
  closing_b_ += by_calibration.transpose() * llt.solve(jump - by_calibration * owed_);
}

void CalibrationEstimator::end_frame() {
  marginalise_shared();
  const Eigen::LLT<Eigen::Matrix3d> llt(xx_);
  const CalibrationMatrix told = bb_ - bx_ * llt.solve(bx_.transpose());
  const CalibrationVector right = b_ - bx_ * llt.solve(x_);
  information_ = (1.0 - kForget) * information_ + kFrameWeight * told + closing_;
  const CalibrationVector step = information_.ldlt().solve(kFrameWeight * right + closing_b_);
  closing_.setZero();
  closing_b_.setZero();
  const CalibrationVector learned = beta_ + owed_ + step;
  broken_ = !(learned.array().abs() < kAbsurd).all();
  if (!broken_) owed_ += step;
}

CalibrationVector CalibrationEstimator::pay(double share) {
  const CalibrationVector part = share * owed_;
  beta_ += part;
  owed_ -= part;
  return part;
}

CalibrationMatrix CalibrationEstimator::covariance() const {
  return information_.inverse();
}

}  // namespace zenith
