// Wheels that arrive in frames of their own: one sample for each pair, at the older stamp.

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "drivers/odometry/wheel_codec_config.h"
#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

// A metre for each turn of the motor.
WheelDecoder odrive_decoder(WheelQuantity quantity = WheelQuantity::kPosition) {
  WheelCodecConfig config;
  config.kind = WheelCodecKind::kOdrive;
  config.geometry.wheel_radius_m = 0.5 / std::numbers::pi;
  config.odrive = {.left_node = 4, .right_node = 2, .quantity = quantity};
  const auto decoder = make_wheel_decoder(config);
  EXPECT_TRUE(decoder.ok());
  return *decoder;
}

CanFrame left(std::int64_t ms, float turns) {
  return odrive::encode_estimates(at_ms(ms), 4, {turns, turns});
}
CanFrame right(std::int64_t ms, float turns) {
  return odrive::encode_estimates(at_ms(ms), 2, {turns, turns});
}

TEST(WheelPairing, GivesOneSampleForEachPairAtTheOlderStamp) {
  WheelDecoder decoder = odrive_decoder();
  EXPECT_FALSE(decoder.decode(left(100, 7.0F)).has_value());
  const auto first = decoder.decode(right(104, -3.0F));
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->stamp, at_ms(100));
  EXPECT_EQ(first->left_m, 0.0);
  EXPECT_EQ(first->right_m, 0.0);
  EXPECT_FALSE(decoder.decode(left(110, 7.03125F)).has_value());
  const auto second = decoder.decode(right(114, -3.03125F));
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->stamp, at_ms(110));
  EXPECT_DOUBLE_EQ(second->left_m, 0.03125);
  EXPECT_DOUBLE_EQ(second->right_m, -0.01875);  // 6 of 10 ms of its step of 31.25 mm
  EXPECT_EQ(decoder.counters().samples, 2u);
  EXPECT_EQ(decoder.counters().unpaired, 0u);
}

TEST(WheelPairing, OrderOfTheWheelsDoesNotMatter) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(right(100, 0.0F));
  decoder.decode(left(102, 0.0F));
  decoder.decode(right(110, 0.01F));
  const auto sample = decoder.decode(left(112, 0.05F));
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->stamp, at_ms(110));
  EXPECT_NEAR(sample->left_m, 0.04, 1e-8);
  EXPECT_NEAR(sample->right_m, 0.01, 1e-8);
}

TEST(WheelPairing, LostFramesOfOneWheelCostNoTravel) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(left(0, 0.0F));
  decoder.decode(right(0, 0.0F));
  decoder.decode(left(10, 0.01F));
  EXPECT_FALSE(decoder.decode(left(20, 0.02F)).has_value());
  EXPECT_FALSE(decoder.decode(left(30, 0.03F)).has_value());
  const auto sample = decoder.decode(right(40, 0.04F));
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->stamp, at_ms(30));
  EXPECT_NEAR(sample->left_m, 0.03, 1e-8);
  EXPECT_NEAR(sample->right_m, 0.03, 1e-8);
  EXPECT_EQ(decoder.counters().unpaired, 2u);
}

TEST(WheelPairing, ASilentWheelSilencesTheSamplesUntilItIsBack) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(left(0, 0.0F));
  decoder.decode(right(0, 0.0F));
  for (int i = 1; i <= 100; ++i) {
    EXPECT_FALSE(decoder.decode(left(10 * i, 0.0F)).has_value());
  }
  EXPECT_EQ(decoder.counters().unpaired, 99u);
  EXPECT_TRUE(decoder.decode(right(1005, 0.0F)).has_value());
  EXPECT_EQ(decoder.counters().samples, 2u);
}

TEST(WheelPairing, RefusesDuplicatesAndLateFramesOfEachWheel) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(left(0, 0.0F));
  decoder.decode(right(5, 0.0F));
  EXPECT_FALSE(decoder.decode(right(5, 0.0F)).has_value());
  EXPECT_FALSE(decoder.decode(left(0, 0.0F)).has_value());
  EXPECT_EQ(decoder.counters().late, 2u);
  // Older than the right wheel's last frame, but newer than the left one's own.
  EXPECT_FALSE(decoder.decode(left(4, 0.004F)).has_value());
  const auto sample = decoder.decode(right(14, 0.009F));
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->stamp, at_ms(4));
  EXPECT_EQ(sample->right_m, 0.0);
  EXPECT_EQ(decoder.counters().late, 2u);
}

TEST(WheelPairing, ARestartOfOneDriveLeavesTheOtherAlone) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(left(0, 50.0F));
  decoder.decode(right(0, 60.0F));
  decoder.decode(left(10, 0.0F));
  const auto sample = decoder.decode(right(10, 60.015625F));
  ASSERT_TRUE(sample.has_value());
  EXPECT_EQ(sample->left_m, 0.0);
  EXPECT_DOUBLE_EQ(sample->right_m, 0.015625);
  EXPECT_EQ(decoder.counters().resets, 1u);
}

TEST(WheelPairing, VelocitiesAreIntegratedForEachWheelAndGapsCounted) {
  WheelDecoder decoder = odrive_decoder(WheelQuantity::kVelocity);
  decoder.decode(left(0, 1.0F));
  decoder.decode(right(0, 0.5F));
  decoder.decode(left(100, 1.0F));
  const auto sample = decoder.decode(right(100, 0.5F));
  EXPECT_DOUBLE_EQ(sample->left_m, 0.1);
  EXPECT_DOUBLE_EQ(sample->right_m, 0.05);
  decoder.decode(left(1100, 1.0F));
  const auto after = decoder.decode(right(1100, 0.5F));
  EXPECT_DOUBLE_EQ(after->left_m, 0.35);  // a quarter of a second of the whole one
  EXPECT_DOUBLE_EQ(after->right_m, 0.175);
  EXPECT_EQ(decoder.counters().velocity_gaps, 2u);
}

TEST(WheelPairing, RefusesWhatIsNoNumber) {
  WheelDecoder decoder = odrive_decoder();
  EXPECT_FALSE(decoder.decode(left(0, std::numeric_limits<float>::quiet_NaN())).has_value());
  EXPECT_FALSE(decoder.decode(right(0, 0.0F)).has_value());
  EXPECT_TRUE(decoder.decode(left(1, 0.0F)).has_value());
  EXPECT_EQ(decoder.counters().invalid, 1u);
}

TEST(WheelPairing, KeepsTheDrivesLastErrors) {
  WheelDecoder decoder = odrive_decoder();
  decoder.decode(odrive::encode_heartbeat(at_ms(0), 2, {0x40, 1}));
  decoder.decode(odrive::encode_heartbeat(at_ms(0), 4, {0, 8}));
  decoder.decode(odrive::encode_heartbeat(at_ms(100), 2, {0x41, 1}));
  EXPECT_EQ(decoder.errors().left, 0u);
  EXPECT_EQ(decoder.errors().right, 0x41u);
  EXPECT_EQ(decoder.counters().error_reports, 2u);
  EXPECT_EQ(decoder.counters().without_travel, 3u);
  decoder.decode(odrive::encode_heartbeat(at_ms(200), 2, {0, 8}));
  EXPECT_EQ(decoder.errors().right, 0u);
  EXPECT_EQ(decoder.counters().error_reports, 2u);
}

}  // namespace
}  // namespace zenith
