#include "tools/report/ate.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace zenith::tools {
namespace {

using Points = std::vector<Eigen::Vector2d>;

TEST(AlignRigid, QuarterTurnByHand) {
  const Points p = {{0, 0}, {1, 0}, {1, 2}};
  const Points q = {{5, 3}, {5, 4}, {3, 4}};  // (x, y) -> (5 - y, 3 + x)
  const Pose2 T = align_rigid(p, q);
  EXPECT_NEAR(T.theta_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(T.x_m, 5.0, 1e-12);
  EXPECT_NEAR(T.y_m, 3.0, 1e-12);
}

TEST(AlignRigid, ExactUnderAnyTransform) {
  const Points p = {{0.3, -1}, {4, 2}, {-2, 5}, {7, 7}};
  for (int degree = -180; degree < 180; degree += 17) {
    const Pose2 truth{3.0, -8.0, degree * std::numbers::pi / 180.0};
    Points q;
    for (const auto& point : p) q.push_back(truth * point);
    const Pose2 T = align_rigid(p, q);
    EXPECT_NEAR(wrap_angle(T.theta_rad - truth.theta_rad), 0.0, 1e-12);
    EXPECT_NEAR((T.position() - truth.position()).norm(), 0.0, 1e-12);
  }
}

TEST(AlignRigid, NothingOrOnePoint) {
  EXPECT_EQ(align_rigid({}, {}).x_m, 0.0);
  const Points p = {{1, 2}};
  const Points q = {{4, 6}};
  const Pose2 T = align_rigid(p, q);
  EXPECT_NEAR((T * p[0] - q[0]).norm(), 0.0, 1e-12);
}

TEST(AbsoluteTrajectoryError, KnownRest) {
  // A square of side 2 against one that is stretched along x by 0.2 on either side: the best fit
  // is the identity, every corner is off by 0.1.
  const Points truth = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const Points estimate = {{-1.1, -1}, {1.1, -1}, {1.1, 1}, {-1.1, 1}};
  const TrajectoryError error = absolute_trajectory_error(estimate, truth);
  EXPECT_NEAR(error.rmse_m, 0.1, 1e-12);
  EXPECT_NEAR(error.max_m, 0.1, 1e-12);
}

TEST(AbsoluteTrajectoryError, IgnoresWhereTheRunStarted) {
  Points truth;
  Points estimate;
  const Pose2 T{10.0, -4.0, 2.0};
  for (int i = 0; i < 100; ++i) {
    truth.push_back({0.1 * i, std::sin(0.1 * i)});
    estimate.push_back(T * truth.back());
  }
  EXPECT_NEAR(absolute_trajectory_error(estimate, truth).rmse_m, 0.0, 1e-9);
}

}  // namespace
}  // namespace zenith::tools
