// The scale of the turns, from sums: right where the wheels' noise bends a regression.

#include "slam/watch/turn_scale.h"

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

TEST(TurnScale, IsUnbiasedByNoiseOfTheWheels) {
  const TestSeed seed;
  Random random(seed.value());
  for (const double scale : {0.8, 1.0, 1.25}) {
    TurnScale sums;
    double told_told = 0.0;
    double told_seen = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double turn_m = (i % 3 == 0 ? -0.03 : 0.03);
      const double told = turn_m + 0.009 * random.normal();
      const double seen = scale * turn_m + 0.002 * random.normal();
      sums.add(0.05, told, seen, 1.0);
      told_told += told * told;
      told_seen += told * seen;
    }
    EXPECT_NEAR(sums.value(), scale, 5.0 * sums.sigma());
    EXPECT_LT(sums.sigma(), 0.01);
    EXPECT_LT(told_seen / told_told, 0.95 * scale);  // what a regression makes of it
  }
}

TEST(TurnScale, ABalanceThatWandersCountsUnlessTurnsCancel) {
  TurnScale one_side;
  TurnScale both_sides;
  for (int i = 0; i < 40; ++i) {
    one_side.add(0.5, 0.03, 0.03, 1.0);
    both_sides.add(0.5, i % 2 == 0 ? 0.03 : -0.03, i % 2 == 0 ? 0.03 : -0.03, 1.0);
  }
  EXPECT_NEAR(one_side.sigma(), 0.0015 * 0.5 / 0.03, 1e-6);
  EXPECT_LT(both_sides.sigma(), 1e-6);
}

TEST(TurnScale, FewTurnsSayNothing) {
  TurnScale sums;
  EXPECT_FALSE(std::isfinite(sums.sigma()));
  sums.add(0.1, 0.03, 0.03, 1.0);
  EXPECT_FALSE(std::isfinite(sums.sigma()));
  EXPECT_DOUBLE_EQ(sums.value(), 1.0);
}

}  // namespace
}  // namespace zenith
