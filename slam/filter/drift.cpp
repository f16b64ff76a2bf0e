#include "slam/filter/drift.h"

namespace zenith {
namespace {

constexpr double kShare = 0.5;
constexpr int kFewMatches = 3;

}  // namespace

Eigen::Matrix3d PlacedDrift::matrix() const {
  const float* c = covariance;
  return (Eigen::Matrix3d() << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]).finished();
}

void PlacedDrift::set(const Eigen::Vector2d& at_m, const Eigen::Matrix3d& D) {
  x_m = static_cast<float>(at_m.x());
  y_m = static_cast<float>(at_m.y());
  const double six[6] = {D(0, 0), D(0, 1), D(0, 2), D(1, 1), D(1, 2), D(2, 2)};
  for (int i = 0; i < 6; ++i) covariance[i] = static_cast<float>(six[i]);
}

PlacedDrift PlacedDrift::moved(const Pose2& T_to_from) const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(T_to_from.theta_rad);
  PlacedDrift out;
  out.set(T_to_from * Eigen::Vector2d(x_m, y_m), R * matrix() * R.transpose());
  return out;
}

Eigen::Matrix3d carried_drift(const PlacedDrift& drift, const Eigen::Vector2d& to_m) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T(0, 2) = -(to_m.y() - static_cast<double>(drift.y_m));
  T(1, 2) = to_m.x() - static_cast<double>(drift.x_m);
  return T * drift.matrix() * T.transpose();
}

Eigen::Matrix2d map_error(const MapErrors& errors, const Eigen::Vector2d& at_m) {
  const Eigen::Vector2d across(-at_m.y(), at_m.x());
  return errors.scale * errors.scale * at_m * at_m.transpose() +
         errors.yaw_rad * errors.yaw_rad * across * across.transpose();
}

void DriftEstimate::add(const PlacedDrift& anchor, double height_m, double noise) {
  const Eigen::Vector2d from(static_cast<double>(anchor.x_m), static_cast<double>(anchor.y_m));
  const double grown = kShare * noise * (camera_m_ - from).norm();
  sum_ += carried_drift(anchor, camera_m_);
  sum_(0, 0) += grown * height_m;
  sum_(1, 1) += grown * height_m;
  sum_(2, 2) += grown / height_m;
  ++count_;
}

void DriftEstimate::end_frame() {
  if (count_ >= kFewMatches && sum_.allFinite()) {
    covariance_ = sum_ / count_;
  } else {
    PlacedDrift here;
    here.set(last_m_, covariance_);
    covariance_ = carried_drift(here, camera_m_);
    if (!covariance_.allFinite()) covariance_ = here.matrix();
  }
  last_m_ = camera_m_;
}

PlacedDrift DriftEstimate::placed() const {
  PlacedDrift here;
  here.set(last_m_, covariance_);
  return here;
}

}  // namespace zenith
