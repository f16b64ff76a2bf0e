#include "slam/map/confidence.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

using V = Eigen::Vector2d;

TEST(Confidence, IsOneWhenThePlaceMovesAsTheRobot) {
  Confidence c;
  for (int i = 0; i <= Confidence::kIncrements; ++i) {
    c.add(V(0.2 * i, 0.1 * i), V(7.0 + 0.2 * i, -3.0 + 0.1 * i), true);
  }
  EXPECT_NEAR(c.value(), 1.0, 1e-12);
}

// The first place gives no increment, and increments that are not yet there count as none.
TEST(Confidence, IsEarnedOverSeveralIncrements) {
  Confidence c;
  double last = c.value();
  EXPECT_NEAR(last, std::exp(-1.0), 1e-12);
  for (int i = 0; i <= Confidence::kIncrements; ++i) {
    c.add(V(0.2 * i, 0.0), V(0.2 * i, 0.0), true);
    EXPECT_NEAR(c.value(), std::exp(-1.0 + static_cast<double>(i) / Confidence::kIncrements),
                1e-12);
    EXPECT_GE(c.value(), last);
    last = c.value();
    if (i < 2) {
      EXPECT_LT(last, 0.55) << "two searches are not enough";
    }
  }
}

TEST(Confidence, StaysBelowHalfWithoutAgreement) {
  Confidence still;
  Confidence backwards;
  Confidence lost;
  for (int i = 0; i < 20; ++i) {
    const V robot(0.2 * i, 0.0);
    still.add(robot, V(4.0, 4.0), true);
    backwards.add(robot, -robot, true);
    lost.add(robot, robot, false);
  }
  EXPECT_NEAR(still.value(), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(backwards.value(), std::exp(-2.0), 1e-12);
  EXPECT_NEAR(lost.value(), std::exp(-1.0), 1e-12);
}

// Eq. 4 with a known deviation: each increment off by 30 % of its length.
TEST(Confidence, FollowsTheEquation) {
  Confidence c;
  for (int i = 0; i <= Confidence::kIncrements; ++i)
    c.add(V(0.2 * i, 0.0), V(0.2 * i, 0.06 * i), true);
  EXPECT_NEAR(c.value(), std::exp(-0.3), 1e-12);
}

TEST(Confidence, OneWildIncrementIsForgottenWithItsWindow) {
  Confidence c;
  for (int i = 0; i < 10; ++i) c.add(V(0.2 * i, 0.0), V(0.2 * i, 0.0), true);
  c.add(V(2.0, 0.0), V(100.0, 0.0), true);
  EXPECT_NEAR(c.value(), std::exp(-3.0 / Confidence::kIncrements), 1e-12);
  for (int i = 11; i < 11 + Confidence::kIncrements; ++i) {
    c.add(V(0.2 * i, 0.0), V(98.0 + 0.2 * i, 0.0), true);
  }
  EXPECT_NEAR(c.value(), 1.0, 1e-12);
}

TEST(Confidence, AStandingRobotDividesByNothing) {
  Confidence c;
  for (int i = 0; i < 10; ++i) c.add(V(1.0, 1.0), V(2.0, 2.0), true);
  EXPECT_TRUE(std::isfinite(c.value()));
  EXPECT_LT(c.value(), 0.5);
}

}  // namespace
}  // namespace zenith
