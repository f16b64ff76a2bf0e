#include "slam/fleet/align.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace zenith {

Pose2 fit_rigid(std::span<const PointPair> pairs) {
  Eigen::Vector2d ca = Eigen::Vector2d::Zero();
  Eigen::Vector2d cb = Eigen::Vector2d::Zero();
  for (const PointPair& p : pairs) {
    ca += p.a;
    cb += p.b;
  }
  ca /= static_cast<double>(pairs.size());
  cb /= static_cast<double>(pairs.size());
  double along = 0.0;
  double across = 0.0;
  for (const PointPair& p : pairs) {
    const Eigen::Vector2d a = p.a - ca;
    const Eigen::Vector2d b = p.b - cb;
    along += a.dot(b);
    across += b.x() * a.y() - b.y() * a.x();
  }
  const double theta = std::atan2(across, along);
  const Eigen::Vector2d t = ca - rotation(theta) * cb;
  return {t.x(), t.y(), theta};
}

Eigen::Matrix<double, 2, 3> transform_jacobian(const Pose2& T, const Eigen::Vector2d& p) {
  const double c = std::cos(T.theta_rad);
  const double s = std::sin(T.theta_rad);
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -s * p.x() - c * p.y(), 0.0, 1.0, c * p.x() - s * p.y();
  return J;
}

Eigen::Matrix2d transform_covariance(const Pose2& T, const Eigen::Matrix3d& T_covariance,
                                     const Eigen::Vector2d& p, const Eigen::Matrix2d& P) {
  const Eigen::Matrix2d R = rotation(T.theta_rad);
  const Eigen::Matrix<double, 2, 3> J = transform_jacobian(T, p);
  return R * P * R.transpose() + J * T_covariance * J.transpose();
}

AlignmentFit fit_alignment(std::span<const PointPair> pairs, const Pose2& start,
                           double cauchy_sigmas) {
  AlignmentFit fit;
  fit.T_a_b = start;
  if (pairs.size() < 2) return fit;
  const double c2 = cauchy_sigmas * cauchy_sigmas;
  for (int iteration = 0; iteration < 12; ++iteration) {
    Eigen::Matrix3d lambda = Eigen::Matrix3d::Zero();
    Eigen::Vector3d eta = Eigen::Vector3d::Zero();
    double sum = 0.0;
    const Eigen::Matrix2d R = rotation(fit.T_a_b.theta_rad);
    for (const PointPair& p : pairs) {
      const Eigen::Matrix2d W = (p.covariance_a + R * p.covariance_b * R.transpose()).inverse();
      const Eigen::Vector2d e = p.a - fit.T_a_b * p.b;
      const double d2 = e.dot(W * e);
      const double weight = 1.0 / (1.0 + d2 / c2);
      const Eigen::Matrix<double, 2, 3> J = transform_jacobian(fit.T_a_b, p.b);
      lambda += weight * J.transpose() * W * J;
      eta += weight * J.transpose() * W * e;
      sum += d2;
    }
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(lambda);
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() <= 0.0) return fit;
    const Eigen::Vector3d step = ldlt.solve(eta);
    const Eigen::Matrix3d covariance = ldlt.solve(Eigen::Matrix3d::Identity());
    // A pair without covariance weighs without bound.
    if (!std::isfinite(step.sum() + covariance.sum() + sum)) {
      fit = AlignmentFit{};
      fit.T_a_b = start;
      return fit;
    }
    fit.T_a_b.x_m += step.x();
    fit.T_a_b.y_m += step.y();
    fit.T_a_b.theta_rad = wrap_angle(fit.T_a_b.theta_rad + step.z());
    fit.mean_squared_distance = sum / static_cast<double>(pairs.size());
    // Two residuals a pair; more scatter than stated means larger covariances than stated.
    fit.covariance = covariance * std::max(1.0, 0.5 * fit.mean_squared_distance);
    fit.ok = true;
    if (step.norm() < 1e-9) break;
  }
  return fit;
}

}  // namespace zenith
