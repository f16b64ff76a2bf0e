#include "slam/fleet/align.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "platform/base/random.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

const Pose2 kTruth = {3.0, -1.5, 2.2};

Eigen::Matrix2d random_covariance(Random& random, double sigma) {
  Eigen::Matrix2d L;
  L << sigma * random.uniform(0.5, 2.0), 0.0, sigma * random.uniform(-1.0, 1.0),
      sigma * random.uniform(0.5, 2.0);
  return L * L.transpose();
}

Eigen::Vector2d draw(const Eigen::Matrix2d& P, Random& random) {
  const double a = random.normal();
  const double b = random.normal();
  return P.llt().matrixL() * Eigen::Vector2d(a, b);
}

// Pairs over 6 m x 6 m, both sides with noise of their own covariances.
std::vector<PointPair> make_pairs(Random& random, int count, double sigma) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    PointPair p;
    const Eigen::Vector2d b(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
    p.covariance_a = random_covariance(random, sigma);
    p.covariance_b = random_covariance(random, sigma);
    p.a = kTruth * b + draw(p.covariance_a, random);
    p.b = b + draw(p.covariance_b, random);
    pairs.push_back(p);
  }
  return pairs;
}

Eigen::Vector3d error(const Pose2& T) {
  return {T.x_m - kTruth.x_m, T.y_m - kTruth.y_m, wrap_angle(T.theta_rad - kTruth.theta_rad)};
}

TEST(Align, RigidFitIsExactWithoutNoise) {
  const TestSeed seed;
  Random random(seed.value());
  auto pairs = make_pairs(random, 5, 1e-9);
  for (PointPair& p : pairs) p.a = kTruth * p.b;
  EXPECT_LT(error(fit_rigid(pairs)).norm(), 1e-12);
  const AlignmentFit fit = fit_alignment(pairs, fit_rigid(pairs));
  ASSERT_TRUE(fit.ok);
  EXPECT_LT(error(fit.T_a_b).norm(), 1e-9);
}

// 500 trials of 15 pairs: the errors' scatter is the stated covariance. e^T P^-1 e has mean 3 with
// deviation sqrt(6 / 500) = 0.11 when it is; Cauchy's weights cost a few per cent of efficiency and
// the inflation by the scatter never goes below one.
TEST(Align, CovarianceIsTheScatter) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kTrials = 500;
  double nees = 0.0;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d stated = Eigen::Matrix3d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto pairs = make_pairs(random, 15, 0.03);
    const AlignmentFit fit = fit_alignment(pairs, fit_rigid(pairs));
    ASSERT_TRUE(fit.ok);
    const Eigen::Vector3d e = error(fit.T_a_b);
    nees += e.dot(fit.covariance.inverse() * e) / kTrials;
    scatter += e * e.transpose() / kTrials;
    stated += fit.covariance / kTrials;
  }
  print_figure("alignment NEES over %d trials: %.2f of 3", kTrials, nees);
  EXPECT_GT(nees, 2.0);
  EXPECT_LT(nees, 3.4);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(scatter(i, i) / stated(i, i), 0.85, 0.35) << i;
}

TEST(Align, MorePairsMakeItSharper) {
  const TestSeed seed;
  Random random(seed.value());
  double last = 1e9;
  for (const int count : {4, 16, 64, 256}) {
    const auto pairs = make_pairs(random, count, 0.03);
    const AlignmentFit fit = fit_alignment(pairs, fit_rigid(pairs));
    EXPECT_LT(fit.covariance.trace(), last);
    last = fit.covariance.trace();
  }
}

TEST(Align, WrongPairsCountLittle) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 50; ++trial) {
    auto pairs = make_pairs(random, 30, 0.02);
    for (std::size_t i = 0; i < 6; ++i) pairs[i].a.x() += random.uniform(0.5, 2.0);
    const AlignmentFit fit = fit_alignment(pairs, fit_rigid(pairs));
    ASSERT_TRUE(fit.ok);
    EXPECT_LT(error(fit.T_a_b).norm(), 0.08) << "trial " << trial;
  }
}

TEST(Align, TellsWhenPairsFixNothing) {
  EXPECT_FALSE(fit_alignment({}, {}).ok);
  std::vector<PointPair> one(1);
  EXPECT_FALSE(fit_alignment(one, {}).ok);
  std::vector<PointPair> here(5);  // all in one place: the angle is free
  EXPECT_FALSE(fit_alignment(here, {}).ok);
}

// Landmarks that are told without any uncertainty, or as no numbers, make no alignment.
TEST(Align, WhatHasNoFiniteFitIsNotOk) {
  for (const double bad :
       {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<PointPair> pairs(8);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i].a = {static_cast<double>(i), static_cast<double>(i * i)};
      pairs[i].b = pairs[i].a + Eigen::Vector2d(0.1, 0.01 * static_cast<double>(i));
      pairs[i].covariance_a *= bad;
      pairs[i].covariance_b *= bad;
    }
    const AlignmentFit fit = fit_alignment(pairs, {});
    EXPECT_TRUE(std::isfinite(fit.T_a_b.x_m + fit.T_a_b.y_m + fit.T_a_b.theta_rad)) << bad;
    EXPECT_TRUE(fit.covariance.allFinite()) << bad;
    EXPECT_FALSE(fit.ok) << bad;
  }
}

TEST(Align, TransformJacobianAgreesWithNumbers) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 100; ++trial) {
    const Pose2 T = {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0),
                     random.uniform(-3.1, 3.1)};
    const Eigen::Vector2d p(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
    const auto moved = [&](double x, double y, double theta) -> Eigen::Vector2d {
      return Pose2{T.x_m + x, T.y_m + y, T.theta_rad + theta} * p;
    };
    Eigen::Matrix<double, 2, 3> J;
    J.col(0) = (moved(kStep, 0, 0) - moved(-kStep, 0, 0)) / (2.0 * kStep);
    J.col(1) = (moved(0, kStep, 0) - moved(0, -kStep, 0)) / (2.0 * kStep);
    J.col(2) = (moved(0, 0, kStep) - moved(0, 0, -kStep)) / (2.0 * kStep);
    ASSERT_LT((transform_jacobian(T, p) - J).norm(), 1e-7) << "trial " << trial;
  }
}

// Fig. 4: the angle's share grows with the squared distance and lies across the line of sight.
TEST(Align, CovarianceStretchesAcrossTheLineOfSight) {
  Eigen::Matrix3d P_T = Eigen::Matrix3d::Zero();
  P_T(2, 2) = 0.01;
  const Eigen::Matrix2d P = 0.0001 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d near = transform_covariance({}, P_T, {1.0, 0.0}, P);
  const Eigen::Matrix2d far = transform_covariance({}, P_T, {3.0, 0.0}, P);
  EXPECT_NEAR(near(0, 0), 0.0001, 1e-12);
  EXPECT_NEAR(near(1, 1), 0.0001 + 0.01, 1e-12);
  EXPECT_NEAR(far(1, 1), 0.0001 + 0.09, 1e-12);
  // A turned alignment turns the stretch with it; the matrix stays symmetric.
  const Eigen::Matrix2d turned = transform_covariance({0.0, 0.0, 0.7}, P_T, {3.0, 0.0}, P);
  const Eigen::Matrix2d R = rotation(0.7);
  EXPECT_LT((turned - R * far * R.transpose()).norm(), 1e-12);
}

}  // namespace
}  // namespace zenith
