#include "tools/clocks/alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace zenith::tools {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kWall = 1'780'000'000 * kSecond;

// Recorded from `from_s` to `to_s` of wall time after kWall by a computer that began `boot_s` then.
RecordedSpan span(const std::string& name, double boot_s, double from_s, double to_s,
                  bool has_clock = true, bool synchronised = true) {
  RecordedSpan r{name,
                 {Duration::from_seconds(from_s - boot_s).ns},
                 {Duration::from_seconds(to_s - boot_s).ns},
                 {}};
  if (has_clock) {
    const Duration wall = {kWall + Duration::from_seconds(boot_s).ns};
    r.clock = ClockLog({{r.first, {}, wall, synchronised}, {r.last, {}, wall, synchronised}});
  }
  return r;
}

TEST(Alignment, TwoUptimesBecomeOneWallTime) {
  const auto a = align({span("a", -500.0, 10.0, 70.0), span("b", -3.0, 40.0, 100.0)}, {});
  ASSERT_TRUE(a.ok()) << a.error().message;
  EXPECT_TRUE(a->wall);
  EXPECT_FALSE(a->disjoint);
  EXPECT_EQ(a->shifts[0].of({510 * kSecond}).ns, kWall + 10 * kSecond);
  EXPECT_EQ(a->shifts[1].of({43 * kSecond}).ns, kWall + 40 * kSecond);
  EXPECT_THAT(a->warnings, IsEmpty());
  EXPECT_THAT(a->notes, ElementsAre(HasSubstr("clock.csv"), HasSubstr("30.0 s in common")));
}

TEST(Alignment, WhatWasRecordedAtOtherTimesIsSaidWithTheGap) {
  const auto a = align({span("a", -500.0, 10.0, 70.0), span("b", -3.0, 90.0, 100.0)}, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->disjoint);
  EXPECT_FALSE(a->unexplained) << "the clocks say so";
  EXPECT_THAT(a->warnings, ElementsAre(AllOf(HasSubstr("a (2026-05-28 20:26:50.0 .. "),
                                             HasSubstr("b begins 20.0 s after the end of a"),
                                             Not(HasSubstr("--align")))));
}

TEST(Alignment, WithoutClocksStampsStayAndUptimesThatDoNotMeetAreToldWithTheWayOut) {
  const std::vector<RecordedSpan> old = {span("a", -500.0, 10.0, 70.0, false),
                                         span("b", -3.0, 20.0, 80.0, false)};
  const auto a = align(old, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->shifts[0].is_none());
  EXPECT_TRUE(a->shifts[1].is_none());
  EXPECT_TRUE(a->unexplained);
  EXPECT_THAT(a->warnings,
              ElementsAre(AllOf(HasSubstr("a begins 427.0 s after the end of b"),
                                HasSubstr("--align start"), HasSubstr("--offset b="))));
  const auto start = align(old, {AlignBy::kStart, {}});
  ASSERT_TRUE(start.ok());
  EXPECT_FALSE(start->disjoint);
  EXPECT_EQ(start->shifts[1].of(old[1].first), old[0].first);
  const auto stated = align(old, {AlignBy::kClocks, {{"b", 497.0}}});
  ASSERT_TRUE(stated.ok());
  EXPECT_FALSE(stated->disjoint);
  EXPECT_THAT(stated->notes, testing::Contains(HasSubstr("50.0 s in common")));
}

TEST(Alignment, OldRecordingsOnOneClockGoOnAsTheyDid) {
  const auto a = align({span("a", 0.0, 10.0, 70.0, false), span("b", 0.0, 20.0, 80.0, false)}, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->shifts[0].is_none() && a->shifts[1].is_none());
  EXPECT_THAT(a->warnings, IsEmpty());
}

TEST(Alignment, OneRecordingStaysOnItsOwnClock) {
  const auto a = align({span("a", -500.0, 10.0, 70.0)}, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->shifts[0].is_none());
  EXPECT_THAT(a->notes, IsEmpty());
  EXPECT_THAT(a->warnings, IsEmpty());
}

TEST(Alignment, WallTimeAsStampsNeedsNoClockFile) {
  RecordedSpan wall = span("b", 0.0, 20.0, 80.0, false);
  wall.first.ns += kWall;
  wall.last.ns += kWall;
  const auto a = align({span("a", -500.0, 10.0, 70.0), wall}, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->wall);
  EXPECT_TRUE(a->shifts[1].is_none());
  EXPECT_FALSE(a->disjoint);
  EXPECT_THAT(a->warnings, IsEmpty());
}

TEST(Alignment, OneWithoutAClockAmongOthersIsNamed) {
  const auto a = align({span("a", -500.0, 10.0, 70.0), span("b", -3.0, 20.0, 80.0, false)}, {});
  ASSERT_TRUE(a.ok());
  EXPECT_FALSE(a->wall);
  EXPECT_TRUE(a->shifts[0].is_none());
  EXPECT_THAT(a->warnings, ElementsAre(HasSubstr("b: without clock.csv"), HasSubstr("--align")));
}

TEST(Alignment, AClockThatWasSetOrNotKeptOrSleptIsTold) {
  RecordedSpan b = span("b", -3.0, 20.0, 80.0, true, false);
  const auto unkept = align({span("a", -500.0, 10.0, 70.0), b}, {});
  ASSERT_TRUE(unkept.ok());
  EXPECT_THAT(unkept->warnings, ElementsAre(AllOf(HasSubstr("b: the wall clock was not synch"),
                                                  HasSubstr("--offset b="))));
  // Set by 3 s in the middle: what it says then holds for the first half, too.
  auto readings = b.clock->readings();
  readings[0].wall.ns -= 3 * kSecond;
  readings[1].synchronised = true;
  b.clock = ClockLog(readings);
  const auto stepped = align({span("a", -500.0, 10.0, 70.0), b}, {});
  ASSERT_TRUE(stepped.ok());
  EXPECT_THAT(stepped->warnings, ElementsAre(HasSubstr("b: the wall clock was set by +3.000 s")));
  EXPECT_EQ(stepped->shifts[1].of(b.first).ns, kWall + 20 * kSecond);
  // Asleep for a minute half way.
  readings = span("b", -3.0, 20.0, 80.0).clock->readings();
  readings.insert(readings.begin() + 1, readings[1]);
  readings[1].monotonic.ns -= 30 * kSecond;
  for (int i : {1, 2}) {
    readings[static_cast<std::size_t>(i)].suspended.ns += 60 * kSecond;
    readings[static_cast<std::size_t>(i)].wall.ns += 60 * kSecond;
  }
  b.clock = ClockLog(readings);
  const auto slept = align({span("a", -500.0, 10.0, 70.0), b}, {});
  ASSERT_TRUE(slept.ok());
  EXPECT_THAT(slept->warnings, ElementsAre(HasSubstr("b: the computer slept for 60.0 s")));
  EXPECT_EQ(slept->shifts[1].of(b.first).ns, kWall + 20 * kSecond);
  EXPECT_EQ(slept->shifts[1].of(b.last).ns, kWall + 140 * kSecond);
}

TEST(Alignment, RefusesWhatCannotBe) {
  const std::vector<RecordedSpan> two = {span("a", 0.0, 10.0, 70.0, false),
                                         span("b", 0.0, 20.0, 80.0, false)};
  const auto unknown = align(two, {AlignBy::kClocks, {{"c", 1.0}}});
  ASSERT_FALSE(unknown.ok());
  EXPECT_THAT(unknown.error().message, HasSubstr("--offset c"));
  const auto before = align(two, {AlignBy::kClocks, {{"b", -21.0}}});
  ASSERT_FALSE(before.ok());
  EXPECT_THAT(before.error().message, HasSubstr("b: its stamps begin at -1.0 s"));
  EXPECT_EQ(ClockShift(Duration{kWall}).of({9'000'000'000'000'000'000}).ns,
            std::numeric_limits<std::int64_t>::max());
}

TEST(Alignment, ReadsStatedOffsets) {
  const auto good = parse_stated_offset("robot-2=-12.5");
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(good->first, "robot-2");
  EXPECT_EQ(good->second, -12.5);
  EXPECT_EQ(parse_stated_offset("a=b=1")->first, "a=b");
  for (const char* wrong : {"", "robot", "=3", "robot=", "robot=x", "robot=1s", "robot=nan",
                            "robot=inf", "robot=1e300"}) {
    EXPECT_FALSE(parse_stated_offset(wrong).ok()) << wrong;
  }
}

}  // namespace
}  // namespace zenith::tools
