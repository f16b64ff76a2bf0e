#include "slam/filter/landmark_fusion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace zenith {
namespace {

Eigen::Vector3d state(const LandmarkRows& l, int i) {
  return {l.ax[i], l.ay[i], l.rho[i]};
}

Eigen::Matrix3d covariance(const LandmarkRows& l, int i) {
  Eigen::Matrix3d P;
  P << l.pxx[i], l.pxy[i], l.pxr[i], l.pxy[i], l.pyy[i], l.pyr[i], l.pxr[i], l.pyr[i], l.prr[i];
  return P;
}

Pose2 anchor(const LandmarkRows& l, int i) {
  return {l.anchor_x[i], l.anchor_y[i], std::atan2(l.anchor_sin[i], l.anchor_cos[i])};
}

// F: from the state at anchor a to the state at anchor b.
Eigen::Matrix3d change_anchor(const Pose2& a, const Pose2& b) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.topLeftCorner<2, 2>() = rotation(a.theta_rad - b.theta_rad);
  F.topRightCorner<2, 1>() = rotation(-b.theta_rad) * (a.position() - b.position());
  return F;
}

void store(const LandmarkRows& l, int i, const Eigen::Vector3d& x, const Eigen::Matrix3d& P) {
  constexpr double kFloor = 1e-9;  // as in update_landmark()
  l.ax[i] = static_cast<float>(x[0]);
  l.ay[i] = static_cast<float>(x[1]);
  l.rho[i] = static_cast<float>(x[2]);
  l.pxx[i] = static_cast<float>(std::max(P(0, 0), kFloor));
  l.pxy[i] = static_cast<float>(P(0, 1));
  l.pxr[i] = static_cast<float>(P(0, 2));
  l.pyy[i] = static_cast<float>(std::max(P(1, 1), kFloor));
  l.pyr[i] = static_cast<float>(P(1, 2));
  l.prr[i] = static_cast<float>(std::max(P(2, 2), kFloor));
}

}  // namespace

void fuse_landmark(const LandmarkRows& own, const LandmarkRows& other,
                   std::span<const Pose2> T_own_other) {
  for (int i = 0; i < static_cast<int>(T_own_other.size()); ++i) {
    const Pose2& T = T_own_other[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d F = change_anchor(anchor(own, i), T * anchor(other, i));
    const Eigen::Vector3d x = state(own, i);
    const Eigen::Matrix3d P = covariance(own, i);
    const Eigen::Matrix3d PFt = P * F.transpose();
    const Eigen::Matrix3d S = F * PFt + covariance(other, i);
    const Eigen::Vector3d e = state(other, i) - F * x;
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(S);
    const double birge = std::max(1.0, e.dot(ldlt.solve(e)) / 3.0);
    const Eigen::Matrix3d K = ldlt.solve(PFt.transpose()).transpose();
    store(own, i, x + K * e, birge * (P - K * PFt.transpose()));
  }
}

}  // namespace zenith
