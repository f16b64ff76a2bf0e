#include "drivers/odometry/canopen.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith::canopen {
namespace {

constexpr std::initializer_list<std::uint8_t> kBytes = {0x01, 0x23, 0x45, 0x67,
                                                        0x89, 0xAB, 0xCD, 0xEF};

TEST(Canopen, ReadsBothWheelsOutOfOnePdo) {
  const Codec codec{
      {.left = {.cob_id = 0x285, .byte_offset = 4}, .right = {.cob_id = 0x285, .byte_offset = 0}}};
  const WheelNews news = codec.read(frame_of({0x285}, kBytes));
  ASSERT_EQ(news.use, FrameUse::kReading);
  EXPECT_EQ(news.left->count, 0xEFCDAB89U);
  EXPECT_EQ(news.right->count, 0x67452301U);
  EXPECT_EQ(codec.ids().size(), 1u);
}

TEST(Canopen, ReadsSixteenBitsAtAnOffset) {
  const Mapping mapping = {.cob_id = 0x181, .byte_offset = 5, .byte_length = 2};
  Codec codec{{.left = mapping, .right = {.cob_id = 0x182}, .quantity = WheelQuantity::kVelocity}};
  const WheelNews news = codec.read(frame_of({0x181}, kBytes));
  ASSERT_TRUE(news.left.has_value());
  EXPECT_FALSE(news.right.has_value());
  EXPECT_EQ(news.left->count, 0xCDABU);
  EXPECT_EQ(news.left->value, -12885.0);
  codec.config.left.is_signed = false;
  EXPECT_EQ(codec.read(frame_of({0x181}, kBytes)).left->value, 52651.0);
}

TEST(Canopen, ReadsSignedAndUnsigned32Bits) {
  Codec codec{{.quantity = WheelQuantity::kVelocity}};
  const CanFrame frame = frame_of({0x182}, {0x85, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(codec.read(frame).right->value, -123.0);
  codec.config.right.is_signed = false;
  EXPECT_EQ(codec.read(frame).right->value, 4294967173.0);
}

TEST(Canopen, EncodesByteExactly) {
  CanFrame frame;
  encode_mapped(frame, {.cob_id = 0x1A3, .byte_offset = 1, .byte_length = 4}, -123456789);
  EXPECT_EQ(frame.length, 5);
  encode_mapped(frame, {.cob_id = 0x1A3, .byte_offset = 5, .byte_length = 2}, -2);
  EXPECT_EQ(frame.length, 7);
  EXPECT_EQ(frame.data, frame_of({}, {0x00, 0xEB, 0x32, 0xA4, 0xF8, 0xFE, 0xFF}).data);
  EXPECT_EQ(id_of(frame), CanId{0x1A3});
}

TEST(Canopen, KnowsItsFramesFromOthers) {
  const Codec codec{{.left = {.cob_id = 0x181, .byte_offset = 2}}};
  EXPECT_EQ(codec.read(frame_of({0x181}, {1, 2, 3, 4, 5})).use, FrameUse::kTooShort);
  EXPECT_EQ(codec.read(frame_of({0x181}, {1, 2, 3, 4, 5, 6})).use, FrameUse::kReading);
  EXPECT_EQ(codec.read(frame_of({0x181, true}, kBytes)).use, FrameUse::kUnknownId);
  EXPECT_EQ(codec.read(frame_of({0x701}, {5})).use, FrameUse::kUnknownId);
}

TEST(Canopen, ScalesByTheMappedLengthAndUnit) {
  const Codec codec{{.left = {.cob_id = 0x181, .byte_length = 2}, .units_per_turn = 1000.0}};
  const WheelScales scales = codec.scales({.wheel_radius_m = 0.5, .gear_ratio = 2.0});
  EXPECT_EQ(scales.left.counter_bits, 16);
  EXPECT_EQ(scales.right.counter_bits, 32);
  EXPECT_EQ(scales.left.kind, WheelKind::kCounter);
  EXPECT_DOUBLE_EQ(scales.left.metres_per_unit, 0.0005 * std::numbers::pi);
  ASSERT_EQ(codec.ids().size(), 2u);
  EXPECT_EQ(codec.ids()[1], CanId{0x182});
}

}  // namespace
}  // namespace zenith::canopen
