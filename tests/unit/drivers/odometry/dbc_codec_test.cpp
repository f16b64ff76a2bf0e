#include "drivers/odometry/dbc_codec.h"

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith::dbc {
namespace {

constexpr DbcSignal kLeft = {.id = {0x0AA},
                             .start_bit = 22,
                             .bit_length = 15,
                             .motorola = true,
                             .scale = 0.01,
                             .offset = -67.67};
constexpr DbcSignal kRight = {
    .id = {0x0AA}, .start_bit = 6, .bit_length = 15, .motorola = true, .scale = 0.01};

TEST(DbcCodec, ReadsVelocitiesOfBothWheelsInOneFrame) {
  const Codec codec = {kLeft, kRight, WheelQuantity::kVelocity, 1.0 / 3.6};
  const WheelNews news = codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26, 0xA1, 0, 0, 0, 0}));
  ASSERT_EQ(news.use, FrameUse::kReading);
  EXPECT_DOUBLE_EQ(news.left->value, 98.89 - 67.67);
  EXPECT_DOUBLE_EQ(news.right->value, 96.53);
  EXPECT_EQ(codec.scales({}).left.kind, WheelKind::kVelocity);
  EXPECT_DOUBLE_EQ(codec.scales({}).right.metres_per_unit, 1.0 / 3.6);
  EXPECT_EQ(codec.ids().size(), 1u);
}

TEST(DbcCodec, PositionsAreCountersOfTheirLengthUnlessFloats) {
  Codec codec = {kLeft, kRight, WheelQuantity::kPosition, 2.0};
  codec.right = {.id = {0x18FF1A0A, true}, .bit_length = 32, .value = DbcValue::kFloat32};
  const WheelScales scales = codec.scales({});
  EXPECT_EQ(scales.left.kind, WheelKind::kCounter);
  EXPECT_EQ(scales.left.counter_bits, 15);
  EXPECT_DOUBLE_EQ(scales.left.metres_per_unit, 0.02);
  EXPECT_EQ(scales.right.kind, WheelKind::kPosition);
  EXPECT_DOUBLE_EQ(scales.right.metres_per_unit, 2.0);
  ASSERT_EQ(codec.ids().size(), 2u);
  EXPECT_EQ(codec.ids()[1], (CanId{0x18FF1A0A, true}));
  const WheelNews news = codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26, 0xA1}));
  EXPECT_EQ(news.left->count, 0x26A1U);
  EXPECT_FALSE(news.right.has_value());
}

TEST(DbcCodec, MultiplexedWheelsComeInTheirFrames) {
  Codec codec = {kLeft, kRight};
  DbcCondition page;
  page.selector = {.id = {0x0AA}, .start_bit = 32, .bit_length = 8};
  page.ranges.push_back({1, 2});
  codec.left_when.push_back(page);
  const auto use = [&](std::uint8_t selector) {
    const WheelNews news = codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26, 0xA1, selector}));
    EXPECT_EQ(news.use, FrameUse::kReading);
    EXPECT_TRUE(news.right.has_value());
    return news.left.has_value();
  };
  EXPECT_FALSE(use(0));
  EXPECT_TRUE(use(1));
  EXPECT_TRUE(use(2));
  EXPECT_FALSE(use(3));
  EXPECT_EQ(codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26, 0xA1})).use, FrameUse::kTooShort);
  codec.right_when = codec.left_when;
  EXPECT_EQ(codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26, 0xA1, 0})).use, FrameUse::kNoTravel);
}

TEST(DbcCodec, KnowsItsFramesFromOthers) {
  const Codec codec = {kLeft, kRight};
  EXPECT_EQ(codec.read(frame_of({0x0AA}, {0x25, 0xB5, 0x26})).use, FrameUse::kTooShort);
  EXPECT_EQ(codec.read(frame_of({0x0AB}, {0x25, 0xB5, 0x26, 0})).use, FrameUse::kUnknownId);
  EXPECT_EQ(codec.read(frame_of({0x0AA, true}, {1, 2, 3, 4})).use, FrameUse::kUnknownId);
}

}  // namespace
}  // namespace zenith::dbc
