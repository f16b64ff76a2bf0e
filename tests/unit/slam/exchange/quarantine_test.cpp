#include "slam/exchange/quarantine.h"

#include <gtest/gtest.h>

namespace zenith::exchange {
namespace {

Time at(double s) {
  return Time{} + Duration::from_seconds(s);
}

TEST(Quarantine, ThreeFaultsWithinAMinute) {
  Quarantine q;
  EXPECT_FALSE(q.fault(at(0), {7}));
  EXPECT_FALSE(q.fault(at(30), {7}));
  EXPECT_FALSE(q.fault(at(61), {7})) << "the first is longer ago than a minute";
  EXPECT_FALSE(q.holds(at(61), {7}));
  EXPECT_TRUE(q.fault(at(62), {7}));
  EXPECT_TRUE(q.holds(at(121), {7}));
  EXPECT_FALSE(q.holds(at(122), {7}));
  EXPECT_FALSE(q.holds(at(100), {8}));
}

TEST(Quarantine, DoublesUpToAnHour) {
  Quarantine q;
  double now = 0.0;
  double length = 0.0;
  for (const double expected : {60.0, 120.0, 240.0, 480.0, 960.0, 1920.0, 3600.0, 3600.0}) {
    for (int i = 0; i < 3; ++i) q.fault(at(now), {7});
    length = 0.0;
    while (q.holds(at(now + length), {7})) length += 1.0;
    EXPECT_EQ(length, expected);
    now += length;
  }
  now += 3601.0;
  for (int i = 0; i < 3; ++i) q.fault(at(now), {7});
  EXPECT_FALSE(q.holds(at(now + 60.0), {7})) << "an hour without a fault forgives";
}

TEST(Quarantine, ForgetsHarmlessOffendersFirst) {
  Quarantine q;
  for (int i = 0; i < 3; ++i) q.fault(at(0), {1});
  for (std::uint64_t robot = 2; robot < 1000; ++robot) q.fault(at(1), {robot});
  EXPECT_TRUE(q.holds(at(2), {1}));
}

}  // namespace
}  // namespace zenith::exchange
