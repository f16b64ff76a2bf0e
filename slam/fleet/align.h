#pragma once
// The map transform from pairs of landmarks (paper III-C, Eq. 5-7, corrected).
//
//   minimise  sum_i  rho( e_i^T W_i e_i ),   e_i = a_i - T b_i,   W_i = (A_i + R B_i R^T)^-1
//
// T is a rotation and a translation in the plane. The start is the closed-form weighted fit
// (Umeyama 1991 in two dimensions, no scale); Gauss and Newton's method with Cauchy's weights then
// uses the covariances A_i, B_i of both sides. The result's covariance is over (x, y, theta).

#include <span>

#include <Eigen/Core>

#include "slam/geometry.h"

namespace zenith {

struct PointPair {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_a = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d covariance_b = Eigen::Matrix2d::Identity();
};

// Closed form, weight one for each pair. Needs two pairs that are apart.
Pose2 fit_rigid(std::span<const PointPair> pairs);

struct AlignmentFit {
  Pose2 T_a_b;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double mean_squared_distance = 0.0;  // Mahalanobis, over all pairs
  // False: too few pairs, all in one place, or pairs of which no finite fit can be made.
  bool ok = false;
};

// Refines `start`; pairs further than `cauchy_sigmas` count less than half.
AlignmentFit fit_alignment(std::span<const PointPair> pairs, const Pose2& start,
                           double cauchy_sigmas = 2.0);

// d (T p) / d (x, y, theta) at T: paper's Eq. 9-10 rests on it.
Eigen::Matrix<double, 2, 3> transform_jacobian(const Pose2& T, const Eigen::Vector2d& p);

// A Gaussian of the peer's frame in the own one (replaces Eq. 9-10): R P R^T + J P_T J^T.
Eigen::Matrix2d transform_covariance(const Pose2& T, const Eigen::Matrix3d& T_covariance,
                                     const Eigen::Vector2d& p, const Eigen::Matrix2d& P);

}  // namespace zenith
