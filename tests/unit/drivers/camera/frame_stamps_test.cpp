#include "drivers/camera/frame_stamps.h"

#include <gtest/gtest.h>

#include <limits>

#include "drivers/camera/frame_sequence.h"

namespace zenith {
namespace {

constexpr Time kNow = {1'000'000'000'000};
constexpr Duration kMs = {1'000'000};

TEST(FrameStamps, BelievesMarkedStampsUpToTenSecondsOld) {
  FrameStamps stamps;
  const auto oldest = stamps.judge(kNow - FrameStamps::kMaxAge, true, kNow);
  EXPECT_EQ(oldest.stamp, kNow - FrameStamps::kMaxAge);
  EXPECT_FALSE(oldest.replaced);
  const auto newest = stamps.judge(kNow, true, kNow);
  EXPECT_EQ(newest.stamp, kNow);
  EXPECT_FALSE(newest.replaced);
}

TEST(FrameStamps, ReplacesOldFutureAndImpossibleStampsByNow) {
  const Time far = {std::numeric_limits<std::int64_t>::max()};
  for (const Time stamp :
       {kNow - FrameStamps::kMaxAge - Duration{1}, kNow + Duration{1}, Time{}, Time{-5}, far}) {
    FrameStamps stamps;
    const auto judged = stamps.judge(stamp, true, kNow);
    EXPECT_TRUE(judged.replaced) << stamp.ns;
    EXPECT_EQ(judged.stamp, kNow) << stamp.ns;
  }
}

TEST(FrameStamps, RiseStrictlyWhateverTheDriverSays) {
  FrameStamps stamps;
  stamps.judge(kNow, true, kNow);
  const auto repeated = stamps.judge(kNow, true, kNow);
  EXPECT_TRUE(repeated.replaced);
  EXPECT_EQ(repeated.stamp, kNow + Duration{1});
  const auto back = stamps.judge(kNow - kMs, true, kNow);
  EXPECT_TRUE(back.replaced);
  EXPECT_EQ(back.stamp, kNow + Duration{2});
}

TEST(FrameStamps, RiseFromStreamToStream) {
  FrameStamps stamps;
  stamps.judge(kNow, true, kNow);
  stamps.new_stream();
  EXPECT_TRUE(stamps.judge(kNow - kMs, true, kNow + kMs).replaced);
}

TEST(FrameStamps, BelievesUnmarkedStampsOfTheLastSecond) {
  FrameStamps stamps;
  EXPECT_FALSE(stamps.judge(kNow - FrameStamps::kMaxUnmarkedAge, false, kNow).replaced);
}

TEST(FrameStamps, NeverMixesTwoClocksInOneStream) {
  FrameStamps stamps;
  EXPECT_TRUE(stamps.judge(kNow - Duration{2'000'000'000}, false, kNow).replaced);
  // By chance near our clock: still of another one.
  const auto chance = stamps.judge(kNow + kMs, false, kNow + kMs + kMs);
  EXPECT_TRUE(chance.replaced);
  EXPECT_EQ(chance.stamp, kNow + kMs + kMs);
  stamps.new_stream();
  EXPECT_FALSE(
      stamps.judge(kNow + Duration{3'000'000}, false, kNow + Duration{4'000'000}).replaced);
}

TEST(FrameSequence, StartsAnywhereCountsGapsAndWraps) {
  FrameSequence sequence;
  EXPECT_EQ(sequence.advance(0xFFFFFFFEu).number, 0u);
  EXPECT_EQ(sequence.advance(0xFFFFFFFFu).number, 1u);
  EXPECT_EQ(sequence.advance(0u).number, 2u);
  const auto step = sequence.advance(4u);
  EXPECT_EQ(step.number, 6u);
  EXPECT_EQ(step.lost, 3u);
}

TEST(FrameSequence, RestartedAndMissingCountersAreTheNextFrame) {
  FrameSequence sequence;
  sequence.advance(500);
  for (const std::uint32_t driver : {500u, 499u, 0u, 0u, FrameSequence::kMaxGap + 1}) {
    const auto step = sequence.advance(driver);
    EXPECT_EQ(step.lost, 0u) << driver;
  }
  const auto largest = sequence.advance(2 * FrameSequence::kMaxGap + 1);
  EXPECT_EQ(largest.number, 5u + FrameSequence::kMaxGap);
  EXPECT_EQ(largest.lost, FrameSequence::kMaxGap - 1);
}

}  // namespace
}  // namespace zenith
