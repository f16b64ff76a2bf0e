#include "drivers/odometry/wheel_accumulator.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

WheelStep feed(WheelAccumulator& wheel, std::int64_t ms, const WheelReading& reading) {
  const WheelStep step = wheel.judge(at_ms(ms), reading);
  if (step != WheelStep::kLate && step != WheelStep::kInvalid) wheel.take(at_ms(ms), reading, step);
  return step;
}

WheelStep count(WheelAccumulator& wheel, std::int64_t ms, std::uint64_t value) {
  return feed(wheel, ms, {.count = value});
}

WheelStep value(WheelAccumulator& wheel, std::int64_t ms, double reading) {
  return feed(wheel, ms, {.value = reading});
}

double travel(const WheelAccumulator& wheel) {
  return wheel.travel_at(wheel.stamp());
}

TEST(WheelAccumulator, UnwrapsCountersOfAnyLength) {
  for (const int bits : {8, 15, 16, 24, 32, 48, 63, 64}) {
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - bits);
    WheelAccumulator wheel({WheelKind::kCounter, bits, 0.001}, {});
    EXPECT_EQ(count(wheel, 0, mask - 2), WheelStep::kFirst);
    EXPECT_EQ(count(wheel, 100, 5), WheelStep::kMoved) << bits;
    EXPECT_DOUBLE_EQ(travel(wheel), 0.008) << bits;
    EXPECT_EQ(count(wheel, 200, mask - 6), WheelStep::kMoved);
    EXPECT_DOUBLE_EQ(travel(wheel), -0.004) << bits;
  }
}

TEST(WheelAccumulator, CoarseCountersMayStepAtOnce) {
  WheelAccumulator wheel({WheelKind::kCounter, 32, 0.03}, {});
  count(wheel, 0, 7);
  EXPECT_EQ(count(wheel, 1, 9), WheelStep::kMoved);
  EXPECT_EQ(count(wheel, 2, 12), WheelStep::kRestarted);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.06);
}

TEST(WheelAccumulator, NegativeUnitsTurnTheDirection) {
  WheelAccumulator wheel({WheelKind::kCounter, 32, -0.001}, {});
  count(wheel, 0, 0);
  count(wheel, 100, 250);
  EXPECT_DOUBLE_EQ(travel(wheel), -0.25);
}

TEST(WheelAccumulator, FollowsPositionsAndTheirRestarts) {
  WheelAccumulator wheel({.kind = WheelKind::kPosition, .metres_per_unit = 0.5}, {});
  EXPECT_EQ(value(wheel, 0, -8000.25), WheelStep::kFirst);
  EXPECT_EQ(value(wheel, 100, -8000.0), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.125);
  EXPECT_EQ(value(wheel, 200, 0.0), WheelStep::kRestarted);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.125);
  EXPECT_EQ(value(wheel, 300, -0.5), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), -0.125);
}

TEST(WheelAccumulator, IntegratesVelocitiesByTrapezoids) {
  WheelAccumulator wheel({.kind = WheelKind::kVelocity, .metres_per_unit = 2.0}, {});
  EXPECT_EQ(value(wheel, 0, 0.5), WheelStep::kFirst);
  EXPECT_EQ(value(wheel, 100, 1.0), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.15);
  EXPECT_EQ(value(wheel, 150, -1.0), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.15);
  EXPECT_EQ(value(wheel, 250, -0.5), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.0);
}

TEST(WheelAccumulator, BoundsTheGapThatAVelocityBridges) {
  WheelAccumulator wheel({.kind = WheelKind::kVelocity}, {.max_velocity_gap_s = 0.2});
  value(wheel, 0, 1.0);
  EXPECT_FALSE(wheel.ends_velocity_gap(at_ms(200)));
  EXPECT_TRUE(wheel.ends_velocity_gap(at_ms(201)));
  EXPECT_EQ(value(wheel, 5000, 1.0), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(wheel), 0.2);
}

TEST(WheelAccumulator, RefusesImpossibleValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  WheelAccumulator speed({.kind = WheelKind::kVelocity, .metres_per_unit = 0.5},
                         {.max_speed_mps = 2.0});
  WheelAccumulator position({.kind = WheelKind::kPosition}, {});
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_EQ(value(speed, 0, bad), WheelStep::kInvalid);
    EXPECT_EQ(value(position, 0, bad), WheelStep::kInvalid);
  }
  EXPECT_EQ(value(speed, 0, 4.0), WheelStep::kFirst);
  EXPECT_EQ(value(speed, 10, -4.1), WheelStep::kInvalid);
  EXPECT_EQ(value(speed, 20, 4.0), WheelStep::kMoved);
  EXPECT_DOUBLE_EQ(travel(speed), 0.04);
  // The largest floats are numbers, too.
  EXPECT_EQ(value(position, 0, 3e38), WheelStep::kFirst);
  EXPECT_EQ(value(position, 10, -3e38), WheelStep::kRestarted);
  EXPECT_EQ(travel(position), 0.0);
}

TEST(WheelAccumulator, RefusesWhatIsNotNewer) {
  WheelAccumulator wheel({}, {});
  EXPECT_EQ(count(wheel, -5, 0), WheelStep::kFirst);
  EXPECT_EQ(count(wheel, -5, 0), WheelStep::kLate);
  EXPECT_EQ(count(wheel, -6, 0), WheelStep::kLate);
  EXPECT_EQ(count(wheel, -4, 0), WheelStep::kMoved);
}

TEST(WheelAccumulator, InterpolatesBetweenTheLastTwoReadings) {
  WheelAccumulator wheel({WheelKind::kCounter, 32, 0.001}, {});
  count(wheel, 100, 0);
  EXPECT_EQ(wheel.travel_at(at_ms(50)), 0.0);
  count(wheel, 200, 40);
  count(wheel, 300, 100);
  EXPECT_DOUBLE_EQ(wheel.travel_at(at_ms(225)), 0.055);
  EXPECT_DOUBLE_EQ(wheel.travel_at(at_ms(200)), 0.040);
  EXPECT_DOUBLE_EQ(wheel.travel_at(at_ms(150)), 0.040);
  EXPECT_DOUBLE_EQ(wheel.travel_at(at_ms(300)), 0.100);
  EXPECT_DOUBLE_EQ(wheel.travel_at(at_ms(900)), 0.100);
}

}  // namespace
}  // namespace zenith
