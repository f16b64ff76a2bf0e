#include "platform/linux/clock.h"

#include <ctime>
#include <regex>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Clock, IsTheKernelsMonotonicClock) {
  timespec before = {};
  timespec after = {};
  clock_gettime(CLOCK_MONOTONIC, &before);
  const Time now = monotonic_now();
  clock_gettime(CLOCK_MONOTONIC, &after);
  EXPECT_GE(now.ns, before.tv_sec * 1'000'000'000 + before.tv_nsec);
  EXPECT_LE(now.ns, after.tv_sec * 1'000'000'000 + after.tv_nsec);
}

TEST(Clock, SleepsAtLeastUntilThen) {
  const Time wake = monotonic_now() + Duration{2'000'000};
  sleep_until(wake);
  EXPECT_GE(monotonic_now(), wake);
}

TEST(Clock, DoesNotSleepForThePast) {
  sleep_until(Time{-5});
  sleep_until(Time{0});
  sleep_until(monotonic_now() - Duration{1});
}

TEST(Clock, WallClockIsReadable) {
  EXPECT_TRUE(
      std::regex_match(wall_clock_text(), std::regex(R"(20\d\d-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3})")))
      << wall_clock_text();
}

}  // namespace
}  // namespace zenith
