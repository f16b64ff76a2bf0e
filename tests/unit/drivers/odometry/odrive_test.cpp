#include "drivers/odometry/odrive.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith::odrive {
namespace {

// Node 5: 5 << 5 | 9 = 0xA9. Every byte that matters differs.
TEST(Odrive, DecodesEstimatesByteExactly) {
  const CanFrame frame = frame_of({0x0A9}, {0x00, 0x00, 0x4A, 0xC1, 0x00, 0x00, 0x4C, 0x40});
  const auto estimates = decode_estimates(frame, 5);
  ASSERT_TRUE(estimates.has_value());
  EXPECT_EQ(estimates->position_turns, -12.625F);
  EXPECT_EQ(estimates->velocity_turns_per_s, 3.1875F);
  EXPECT_FALSE(decode_estimates(frame, 4).has_value());
}

TEST(Odrive, EncodesEstimatesByteExactly) {
  const CanFrame frame = encode_estimates(Time{7}, 5, {-12.625F, 3.1875F});
  EXPECT_EQ(frame.data, frame_of({}, {0x00, 0x00, 0x4A, 0xC1, 0x00, 0x00, 0x4C, 0x40}).data);
  EXPECT_EQ(id_of(frame), CanId{0x0A9});
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.stamp, Time{7});
}

TEST(Odrive, DecodesHeartbeatByteExactly) {
  const auto beat =
      decode_heartbeat(frame_of({0x0A1}, {0x04, 0x03, 0x02, 0x01, 0x08, 0x55, 0x66, 0x77}), 5);
  ASSERT_TRUE(beat.has_value());
  EXPECT_EQ(beat->axis_error, 0x01020304U);
  EXPECT_EQ(beat->axis_state, 8);
  const CanFrame frame = encode_heartbeat(Time{}, 5, {0x01020304U, 8});
  EXPECT_EQ(frame.data, frame_of({}, {0x04, 0x03, 0x02, 0x01, 0x08}).data);
  EXPECT_EQ(id_of(frame), CanId{0x0A1});
}

TEST(Odrive, TellsTheWheelsApart) {
  const Codec codec{{.left_node = 5, .right_node = 3}};
  const WheelNews left = codec.read(encode_estimates(Time{}, 5, {1.5F, -0.25F}));
  ASSERT_EQ(left.use, FrameUse::kReading);
  ASSERT_TRUE(left.left.has_value());
  EXPECT_FALSE(left.right.has_value());
  EXPECT_EQ(left.left->value, 1.5);
  const WheelNews right = codec.read(encode_estimates(Time{}, 3, {2.5F, 0.75F}));
  ASSERT_TRUE(right.right.has_value());
  EXPECT_FALSE(right.left.has_value());
  EXPECT_EQ(right.right->value, 2.5);
}

TEST(Odrive, ReadsTheVelocityWhenAsked) {
  const Codec codec{{.quantity = WheelQuantity::kVelocity}};
  EXPECT_EQ(codec.read(encode_estimates(Time{}, 1, {2.5F, -0.75F})).right->value, -0.75);
  EXPECT_EQ(codec.scales({}).left.kind, WheelKind::kVelocity);
}

TEST(Odrive, HeartbeatsTellErrorsAndNoTravel) {
  const Codec codec{{.left_node = 5, .right_node = 3}};
  const WheelNews news = codec.read(encode_heartbeat(Time{}, 3, {0x40, 1}));
  EXPECT_EQ(news.use, FrameUse::kNoTravel);
  EXPECT_FALSE(news.left_error.has_value());
  EXPECT_EQ(news.right_error, 0x40U);
}

TEST(Odrive, KnowsItsFramesFromOthers) {
  const Codec codec{{.left_node = 5, .right_node = 3}};
  CanFrame frame = encode_estimates(Time{}, 5, {});
  frame.length = 7;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kTooShort);
  frame.length = 8;
  frame.extended = true;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kUnknownId);
  frame = encode_heartbeat(Time{}, 5, {});
  frame.length = 4;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kTooShort);
  EXPECT_EQ(codec.read(encode_estimates(Time{}, 4, {})).use, FrameUse::kUnknownId);
  EXPECT_EQ(codec.read(frame_of({5U << 5U | 0x17U}, {1, 2})).use, FrameUse::kNoTravel);
}

TEST(Odrive, ScalesByWheelAndGear) {
  const WheelScales scales = Codec{}.scales({.wheel_radius_m = 0.2, .gear_ratio = 8.0});
  EXPECT_DOUBLE_EQ(scales.left.metres_per_unit, 0.05 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(scales.right.metres_per_unit, 0.05 * std::numbers::pi);
  EXPECT_EQ(scales.left.kind, WheelKind::kPosition);
}

TEST(Odrive, ListsItsIdentifiers) {
  const CanIds ids = Codec{{.left_node = 5, .right_node = 3}}.ids();
  ASSERT_EQ(ids.size(), 4u);
  EXPECT_EQ(ids[0], CanId{0x0A9});
  EXPECT_EQ(ids[1], CanId{0x0A1});
  EXPECT_EQ(ids[2], CanId{0x069});
  EXPECT_EQ(ids[3], CanId{0x061});
}

}  // namespace
}  // namespace zenith::odrive
