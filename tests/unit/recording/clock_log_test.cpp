#include "platform/recording/clock_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/clock.h"

namespace zenith {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kWall = 1'780'000'000 * kSecond;

ClockReading reading(double monotonic_s, double slept_s, double set_s, bool synchronised = true) {
  const Duration slept = Duration::from_seconds(slept_s);
  return {{Duration::from_seconds(monotonic_s).ns},
          slept,
          {kWall + slept.ns + Duration::from_seconds(set_s).ns},
          synchronised};
}

Result<ClockLog> parse(std::string_view text) {
  InputLines lines(text, "clock.csv", {1 << 20});
  return parse_clock_log(lines);
}

TEST(ClockLog, StampsBecomeWallTime) {
  const ClockLog log({reading(10.0, 0.0, 0.0), reading(70.0, 0.0, 0.0)});
  for (const double s : {0.0, 10.0, 33.0, 70.0, 1000.0}) {
    EXPECT_EQ(log.offset({Duration::from_seconds(s).ns}).ns, kWall) << s;
  }
  EXPECT_TRUE(log.synchronised());
  EXPECT_EQ(log.stepped(), Duration{});
  EXPECT_EQ(log.slept(), Duration{});
}

TEST(ClockLog, AStepOfTheWallClockIsACorrectionOfTheWhole) {
  // Begun without network; NTP sets the clock by 3.2 s after 20 s.
  const ClockLog log({reading(10.0, 0.0, -3.2, false), reading(30.0, 0.0, 0.0, true),
                      reading(70.0, 0.0, 0.0, true)});
  EXPECT_EQ(log.offset({15 * kSecond}).ns, kWall);
  EXPECT_EQ(log.offset({50 * kSecond}).ns, kWall);
  EXPECT_TRUE(log.synchronised());
  EXPECT_NEAR(log.stepped().seconds(), 3.2, 1e-9);
}

TEST(ClockLog, WhatWasSynchronisedIsTrustedBeforeWhatCameLast) {
  const ClockLog log({reading(10.0, 0.0, 0.0, true), reading(30.0, 0.0, 500.0, false)});
  EXPECT_EQ(log.offset({50 * kSecond}).ns, kWall);
  EXPECT_TRUE(log.synchronised());
  const ClockLog never({reading(10.0, 0.0, 1.0, false), reading(30.0, 0.0, 2.0, false)});
  EXPECT_EQ(never.offset({50 * kSecond}).ns, kWall + 2 * kSecond);
  EXPECT_FALSE(never.synchronised());
}

TEST(ClockLog, TimeAsleepIsTimeThatPassed) {
  const ClockLog log({reading(10.0, 5.0, 0.0), reading(30.0, 65.0, 0.0), reading(70.0, 65.0, 0.0)});
  const Duration before = log.offset({29 * kSecond});
  const Duration after = log.offset({31 * kSecond});
  EXPECT_NEAR(Duration{after.ns - before.ns}.seconds(), 60.0, 1e-9);
  EXPECT_EQ(after.ns, kWall + 65 * kSecond);
  EXPECT_EQ(log.slept().ns, 60 * kSecond);
  EXPECT_EQ(log.stepped(), Duration{}) << "nobody has set the clock";
}

TEST(ClockLog, ASleepThatIsReadAgainIsTheSameOne) {
  // Two calls are microseconds apart; no stamp may fall behind the one before because of that.
  std::vector<ClockReading> readings;
  for (int i = 0; i < 50; ++i) {
    readings.push_back(reading(10.0 + i, 5.0, 0.0));
    readings.back().suspended.ns += (i * 7919) % 3000;
    readings.back().wall.ns -= (i * 104729) % 3000;
  }
  const ClockLog log(readings);
  for (int i = 1; i < 50; ++i) {
    EXPECT_EQ(log.offset({(10 + i) * kSecond}), log.offset({10 * kSecond})) << i;
  }
}

TEST(ClockLog, OnlyChangesAreWorthALine) {
  ClockChanges changes;
  EXPECT_TRUE(changes.is_change(reading(1.0, 0.0, 0.0)));
  EXPECT_FALSE(changes.is_change(reading(2.0, 0.0, 0.0)));
  EXPECT_FALSE(changes.is_change(reading(3.0, 0.0, 0.0004)));
  EXPECT_TRUE(changes.is_change(reading(4.0, 0.0, 0.01)));
  EXPECT_FALSE(changes.is_change(reading(5.0, 0.0, 0.01)));
  EXPECT_TRUE(changes.is_change(reading(6.0, 2.0, 0.01)));
  EXPECT_TRUE(changes.is_change(reading(7.0, 2.0, 0.01, false)));
  EXPECT_FALSE(changes.is_change(reading(8.0, 2.0, 0.01, false)));
}

TEST(ClockLog, ComesBackAsItWasWritten) {
  const std::vector<ClockReading> readings = {reading(10.0, 5.0, -2.0, false),
                                              reading(20.0, 6.0, 0.0)};
  std::string text = kClockLogHeader;
  for (const ClockReading& r : readings) text += format_clock_reading(r);
  const auto log = parse(text);
  ASSERT_TRUE(log.ok()) << log.error().message;
  EXPECT_EQ(log->readings(), readings);
}

TEST(ClockLog, SaysWhatIsWrongWithAFile) {
  const std::pair<const char*, const char*> wrongs[] = {
      {"", "expected a line at least"},
      {"#monotonic\n", "expected a line at least"},
      {"1,2,3\n", "clock.csv:1: expected 'monotonic"},
      {"1,2,3,4\n", "clock.csv:1: expected 'monotonic"},
      {"1,2,3,1x\n", "expected 'monotonic"},
      {"-1,2,3,1\n", "expected 'monotonic"},
      {"1,-2,3,1\n", "expected 'monotonic"},
      {"1,2,9223372036854775807,1\n", "expected 'monotonic"},
      {"9223372036854775807,2,3,1\n", "expected 'monotonic"},
      {"1,2,3,1,\n", "expected 'monotonic"},
      {"5,2,3,1\n4,2,3,1\n", "clock.csv:2: expected times that do not fall"},
      {"5,9000000,3,1\n6,2,3,1\n", "clock.csv:2: expected times that do not fall"},
  };
  for (const auto& [text, told] : wrongs) {
    const auto log = parse(text);
    ASSERT_FALSE(log.ok()) << text;
    EXPECT_THAT(log.error().message, HasSubstr(told)) << text;
  }
}

TEST(ClockReadings, AreThoseOfThisComputer) {
  const Time before = monotonic_now();
  const ClockReading now = read_clocks();
  EXPECT_GE(now.monotonic, before);
  EXPECT_LE(now.monotonic, monotonic_now());
  EXPECT_GE(now.suspended.ns, 0);
  EXPECT_NEAR(now.wall.seconds(), system_clock_offset().seconds(), 0.001);
}

}  // namespace
}  // namespace zenith
