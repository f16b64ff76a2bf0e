#include "drivers/camera/sensor_clock.h"

#include <gtest/gtest.h>

namespace zenith {
namespace {

constexpr Time kNow = {5'000'000'000'000};
constexpr Duration kAge = {30'000'000};
constexpr Duration kNight = {8LL * 3600 * 1'000'000'000};

TEST(SensorClock, MonotonicStampsStayAsTheyAre) {
  SensorClock clock;
  EXPECT_EQ(clock.to_monotonic(kNow - kAge, kNow, kNight), kNow - kAge);
  EXPECT_EQ(clock.to_monotonic(kNow - kAge, kNow, {}), kNow - kAge);
}

TEST(SensorClock, StampsOfTheTimeSinceBootLoseTheTimeAsleep) {
  SensorClock clock;
  const Time stamp = kNow - kAge + kNight;
  EXPECT_EQ(clock.to_monotonic(stamp, kNow, kNight), kNow - kAge);
}

TEST(SensorClock, AStreamKeepsTheClockThatItShowed) {
  SensorClock clock;
  const Duration nap = {50'000'000};
  clock.to_monotonic(kNow - kAge + nap, kNow, nap);
  const Duration old = {80'000'000};  // by itself it might be of either clock
  EXPECT_EQ(clock.to_monotonic(kNow - old + nap, kNow, nap), kNow - old);
  clock.new_stream();
  EXPECT_EQ(clock.to_monotonic(kNow - old + nap, kNow, nap), kNow - old + nap);
}

TEST(SensorClock, StampsOfNeitherClockAreLeftToOthers) {
  SensorClock clock;
  const Time stamp = kNow + kNight + Duration{1};
  EXPECT_EQ(clock.to_monotonic(stamp, kNow, kNight), stamp);
  EXPECT_EQ(clock.to_monotonic(stamp, kNow, {}), stamp);
}

}  // namespace
}  // namespace zenith
