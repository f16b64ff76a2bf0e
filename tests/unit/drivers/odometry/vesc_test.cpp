#include "drivers/odometry/vesc.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith::vesc {
namespace {

constexpr CanId kStatus1Of27 = {0x0000091B, true};
constexpr CanId kStatus5Of27 = {0x00001B1B, true};

TEST(Vesc, DecodesStatus1ByteExactly) {
  const CanFrame frame = frame_of(kStatus1Of27, {0xFF, 0xFE, 0xC7, 0x8D, 0x00, 0x7B, 0xFE, 0x0C});
  const auto status = decode_status1(frame, 27);
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->erpm, -79987);
  EXPECT_DOUBLE_EQ(status->current_a, 12.3);
  EXPECT_DOUBLE_EQ(status->duty, -0.5);
  EXPECT_FALSE(decode_status1(frame, 28).has_value());
}

TEST(Vesc, EncodesStatus1ByteExactly) {
  const CanFrame frame = encode_status1(Time{9}, 27, {-79987, 12.3, -0.5});
  EXPECT_EQ(frame.data, frame_of({}, {0xFF, 0xFE, 0xC7, 0x8D, 0x00, 0x7B, 0xFE, 0x0C}).data);
  EXPECT_EQ(id_of(frame), kStatus1Of27);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.stamp, Time{9});
}

TEST(Vesc, DecodesStatus5ByteExactlyInBothLengths) {
  const auto old = decode_status5(frame_of(kStatus5Of27, {0x12, 0x34, 0x56, 0x78, 0x01, 0xE3}), 27);
  ASSERT_TRUE(old.has_value());
  EXPECT_EQ(old->tachometer, 0x12345678);
  EXPECT_DOUBLE_EQ(old->input_voltage_v, 48.3);
  const auto now =
      decode_status5(frame_of(kStatus5Of27, {0x87, 0x65, 0x43, 0x21, 0x01, 0xE3, 0x11, 0x22}), 27);
  ASSERT_TRUE(now.has_value());
  EXPECT_EQ(now->tachometer, -2023406815);
}

TEST(Vesc, EncodesStatus5ByteExactly) {
  const CanFrame frame = encode_status5(Time{}, 27, {-2023406815, 48.3});
  EXPECT_EQ(frame.data, frame_of({}, {0x87, 0x65, 0x43, 0x21, 0x01, 0xE3, 0x00, 0x00}).data);
  EXPECT_EQ(id_of(frame), kStatus5Of27);
}

TEST(Vesc, ReadsPositionOrVelocityOfEachWheel) {
  const Codec position{{.left_id = 27, .right_id = 4}};
  const WheelNews left = position.read(encode_status5(Time{}, 27, {-5, 0.0}));
  ASSERT_TRUE(left.left.has_value());
  EXPECT_FALSE(left.right.has_value());
  EXPECT_EQ(left.left->count, 0xFFFFFFFBU);
  EXPECT_EQ(position.read(encode_status1(Time{}, 27, {5})).use, FrameUse::kNoTravel);

  const Codec velocity{{.left_id = 27, .right_id = 4, .quantity = WheelQuantity::kVelocity}};
  const WheelNews right = velocity.read(encode_status1(Time{}, 4, {-4200}));
  ASSERT_TRUE(right.right.has_value());
  EXPECT_FALSE(right.left.has_value());
  EXPECT_EQ(right.right->value, -4200.0);
  EXPECT_EQ(velocity.read(encode_status5(Time{}, 4, {5})).use, FrameUse::kNoTravel);
}

TEST(Vesc, KnowsItsFramesFromOthers) {
  const Codec codec{{.left_id = 27, .right_id = 4}};
  CanFrame frame = encode_status5(Time{}, 27, {});
  frame.length = 5;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kTooShort);
  frame.length = 6;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kReading);
  frame.extended = false;
  EXPECT_EQ(codec.read(frame).use, FrameUse::kUnknownId);
  EXPECT_EQ(codec.read(encode_status5(Time{}, 5, {})).use, FrameUse::kUnknownId);
}

TEST(Vesc, ScalesCountsAndElectricalTurns) {
  const WheelGeometry geometry = {.wheel_radius_m = 0.1, .gear_ratio = 5.0};
  const double turn_m = 0.04 * std::numbers::pi;
  const WheelScales counts = Codec{{.counts_per_turn = 90.0}}.scales(geometry);
  EXPECT_EQ(counts.left.kind, WheelKind::kCounter);
  EXPECT_EQ(counts.left.counter_bits, 32);
  EXPECT_DOUBLE_EQ(counts.right.metres_per_unit, turn_m / 90.0);
  const Codec velocity{{.quantity = WheelQuantity::kVelocity, .pole_pairs = 15.0}};
  EXPECT_EQ(velocity.scales(geometry).left.kind, WheelKind::kVelocity);
  // 900 ERPM of 15 pole pairs are one turn a second.
  EXPECT_DOUBLE_EQ(900.0 * velocity.scales(geometry).left.metres_per_unit, turn_m);
}

TEST(Vesc, ListsTheFramesOfItsQuantity) {
  const CanIds position = Codec{{.left_id = 27, .right_id = 4}}.ids();
  ASSERT_EQ(position.size(), 2u);
  EXPECT_EQ(position[0], kStatus5Of27);
  EXPECT_EQ(position[1], (CanId{0x1B04, true}));
  EXPECT_EQ((Codec{{.left_id = 27, .quantity = WheelQuantity::kVelocity}}.ids()[0]), kStatus1Of27);
}

}  // namespace
}  // namespace zenith::vesc
