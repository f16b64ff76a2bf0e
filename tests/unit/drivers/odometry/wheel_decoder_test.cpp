#include "drivers/odometry/wheel_decoder.h"

#include <limits>

#include <gtest/gtest.h>

#include "drivers/odometry/agilex_v2.h"

namespace zenith {
namespace {

CanFrame at_ms(std::int64_t ms, std::int32_t left_mm, std::int32_t right_mm) {
  return agilex_v2::encode_odometer(Time{ms * 1'000'000}, {left_mm, right_mm});
}

TEST(WheelDecoder, FirstSampleHasNoTravelAndLaterOnesAddUp) {
  WheelDecoder decoder;
  const auto first = decoder.decode(at_ms(0, 5000, -700));
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->left_m, 0.0);
  EXPECT_EQ(first->right_m, 0.0);
  const auto second = decoder.decode(at_ms(10, 5011, -707));
  ASSERT_TRUE(second.has_value());
  EXPECT_DOUBLE_EQ(second->left_m, 0.011);
  EXPECT_DOUBLE_EQ(second->right_m, -0.007);
  EXPECT_EQ(second->stamp, Time{10'000'000});
}

TEST(WheelDecoder, UnwrapsBothEndsOfThe32BitCounter) {
  constexpr auto kMax = std::numeric_limits<std::int32_t>::max();
  constexpr auto kMin = std::numeric_limits<std::int32_t>::min();
  WheelDecoder decoder;
  decoder.decode(at_ms(0, kMax - 2, kMin + 1));
  const auto sample = decoder.decode(at_ms(10, kMin + 3, kMax - 4));
  ASSERT_TRUE(sample.has_value());
  EXPECT_DOUBLE_EQ(sample->left_m, 0.006);
  EXPECT_DOUBLE_EQ(sample->right_m, -0.006);
  EXPECT_EQ(decoder.counters().resets, 0u);
}

TEST(WheelDecoder, RestartedCounterContinuesTheTotalWithoutMotion) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 90'000, 80'000));
  decoder.decode(at_ms(10, 90'005, 80'004));
  const auto reset = decoder.decode(at_ms(20, 0, 0));
  ASSERT_TRUE(reset.has_value());
  EXPECT_DOUBLE_EQ(reset->left_m, 0.005);
  EXPECT_DOUBLE_EQ(reset->right_m, 0.004);
  EXPECT_EQ(decoder.counters().resets, 1u);
  const auto next = decoder.decode(at_ms(30, 3, 2));
  EXPECT_DOUBLE_EQ(next->left_m, 0.008);
  EXPECT_DOUBLE_EQ(next->right_m, 0.006);
}

TEST(WheelDecoder, JumpOfOneWheelAloneIsAResetOfBoth) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 0, 0));
  const auto sample = decoder.decode(at_ms(10, 4, 5000));
  EXPECT_EQ(sample->left_m, 0.0);
  EXPECT_EQ(sample->right_m, 0.0);
  EXPECT_EQ(decoder.counters().resets, 1u);
}

TEST(WheelDecoder, SpeedLimitIsConfigurableAndGrowsWithTheGap) {
  WheelDecoder slow(WheelLimits{.max_speed_mps = 1.0});
  slow.decode(at_ms(0, 0, 0));
  EXPECT_DOUBLE_EQ(slow.decode(at_ms(1000, 900, 950))->right_m, 0.950);
  EXPECT_DOUBLE_EQ(slow.decode(at_ms(1100, 1100, 1150))->right_m, 0.950);
  EXPECT_EQ(slow.counters().resets, 1u);
}

TEST(WheelDecoder, RefusesDuplicatedAndLateFrames) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 0, 0));
  decoder.decode(at_ms(20, 10, 11));
  EXPECT_FALSE(decoder.decode(at_ms(20, 10, 11)).has_value());
  EXPECT_FALSE(decoder.decode(at_ms(10, 5, 6)).has_value());
  EXPECT_EQ(decoder.counters().late, 2u);
  EXPECT_DOUBLE_EQ(decoder.decode(at_ms(30, 15, 17))->left_m, 0.015);
}

// Ten metres in three quiet seconds: no wheel drove them, the base was switched off and on.
TEST(WheelDecoder, DoesNotBelieveLongStepsAfterALongSilence) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 10'500, 10'400));
  const auto sample = decoder.decode(at_ms(60'000, 200, 300));
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->left_m, 0.0);
  EXPECT_EQ(sample->right_m, 0.0);
  EXPECT_EQ(decoder.counters().resets, 1u);
}

TEST(WheelDecoder, BelievesWhatWasDrivenDuringAShortSilence) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 10'500, 10'400));
  EXPECT_DOUBLE_EQ(decoder.decode(at_ms(1500, 11'700, 11'500))->left_m, 1.2);
  EXPECT_EQ(decoder.counters().resets, 0u);
}

TEST(WheelDecoder, ZeroAfterHalfASecondOfSilenceIsARestart) {
  WheelDecoder decoder;
  decoder.decode(at_ms(0, 1500, 1400));
  EXPECT_EQ(decoder.decode(at_ms(600, 0, 0))->left_m, 0.0);
  EXPECT_EQ(decoder.counters().resets, 1u);
  decoder.decode(at_ms(610, 7, 7));
  EXPECT_DOUBLE_EQ(decoder.decode(at_ms(1300, 0, 0))->left_m, 0.0);  // rolled back by 7 mm
  EXPECT_EQ(decoder.counters().resets, 1u);
  decoder.decode(at_ms(1400, 300, 300));
  EXPECT_DOUBLE_EQ(decoder.decode(at_ms(1600, 0, 0))->left_m, 0.0);  // drove back through zero
  EXPECT_EQ(decoder.counters().resets, 1u);
}

TEST(WheelDecoder, TellsTheIdentifiersThatItReads) {
  ASSERT_EQ(WheelDecoder().ids().size(), 1u);
  EXPECT_EQ(WheelDecoder().ids()[0], CanId{0x311});
}

TEST(WheelDecoder, CountsWhatItCannotUse) {
  WheelDecoder decoder;
  CanFrame frame = at_ms(0, 1, 2);
  frame.length = 4;
  EXPECT_FALSE(decoder.decode(frame).has_value());
  frame = at_ms(0, 1, 2);
  frame.extended = true;
  EXPECT_FALSE(decoder.decode(frame).has_value());
  frame = at_ms(0, 1, 2);
  frame.id = 0x251;
  EXPECT_FALSE(decoder.decode(frame).has_value());
  EXPECT_FALSE(decoder.decode(agilex_v2::encode_motion(Time{}, {})).has_value());
  EXPECT_EQ(decoder.counters().short_frames, 1u);
  EXPECT_EQ(decoder.counters().unknown_ids, 2u);
  EXPECT_EQ(decoder.counters().without_travel, 1u);
  EXPECT_EQ(decoder.counters().samples, 0u);
}

}  // namespace
}  // namespace zenith
