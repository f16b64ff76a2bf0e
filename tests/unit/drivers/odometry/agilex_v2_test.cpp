#include "drivers/odometry/agilex_v2.h"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

namespace zenith::agilex_v2 {
namespace {

CanFrame raw(std::uint32_t id, std::array<std::uint8_t, 8> data) {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  frame.data = data;
  return frame;
}

// Every byte differs: a swapped byte order, wheel or field shows.
TEST(AgilexV2, DecodesOdometerByteExactly) {
  const auto odometer =
      decode_odometer(raw(0x311, {0x01, 0x23, 0x45, 0x67, 0xFE, 0xDC, 0xBA, 0x98}));
  ASSERT_TRUE(odometer.has_value());
  EXPECT_EQ(odometer->left_mm, 19088743);
  EXPECT_EQ(odometer->right_mm, -19088744);
}

TEST(AgilexV2, EncodesOdometerByteExactly) {
  const CanFrame frame = encode_odometer(Time{5}, {42, -43});
  const std::array<std::uint8_t, 8> expected = {0, 0, 0, 0x2A, 0xFF, 0xFF, 0xFF, 0xD5};
  EXPECT_EQ(frame.data, expected);
  EXPECT_EQ(frame.id, 0x311u);
  EXPECT_EQ(frame.length, 8);
  EXPECT_FALSE(frame.extended);
  EXPECT_EQ(frame.stamp, Time{5});
}

TEST(AgilexV2, DecodesMotionByteExactly) {
  const auto motion = decode_motion(raw(0x221, {0x01, 0xF4, 0xFF, 0x38, 0x00, 0x0B, 0x80, 0x00}));
  ASSERT_TRUE(motion.has_value());
  EXPECT_DOUBLE_EQ(motion->linear_mps, 0.5);
  EXPECT_DOUBLE_EQ(motion->angular_radps, -0.2);
  EXPECT_DOUBLE_EQ(motion->lateral_mps, 0.011);
  EXPECT_DOUBLE_EQ(motion->steering_rad, -32.768);
}

TEST(AgilexV2, EncodesMotionByteExactlyAndSaturates) {
  const CanFrame frame = encode_motion(Time{}, {0.5, -0.2, 0.011, -99.0});
  const std::array<std::uint8_t, 8> expected = {0x01, 0xF4, 0xFF, 0x38, 0x00, 0x0B, 0x80, 0x00};
  EXPECT_EQ(frame.data, expected);
  const CanFrame high = encode_motion(Time{}, {99.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(high.data[0], 0x7F);
  EXPECT_EQ(high.data[1], 0xFF);
}

TEST(AgilexV2, RoundTripsTheEndsOfTheRange) {
  for (const std::int32_t value : {std::numeric_limits<std::int32_t>::min(), -1, 0, 1,
                                   std::numeric_limits<std::int32_t>::max()}) {
    const auto odometer = decode_odometer(encode_odometer(Time{}, {value, 7}));
    ASSERT_TRUE(odometer.has_value());
    EXPECT_EQ(odometer->left_mm, value);
    EXPECT_EQ(odometer->right_mm, 7);
  }
}

TEST(AgilexV2, RefusesWrongFrames) {
  CanFrame frame = encode_odometer(Time{}, {1, 2});
  frame.length = 7;
  EXPECT_FALSE(decode_odometer(frame).has_value());
  frame.length = 8;
  frame.extended = true;
  EXPECT_FALSE(decode_odometer(frame).has_value());
  frame.extended = false;
  EXPECT_FALSE(decode_motion(frame).has_value());
}

TEST(AgilexV2, CodecReadsTheOdometerAndKnowsTheMotionFrame) {
  const CanFrame frame = raw(0x311, {0x01, 0x23, 0x45, 0x67, 0xFE, 0xDC, 0xBA, 0x98});
  const WheelNews news = Codec{}.read(frame);
  ASSERT_EQ(news.use, FrameUse::kReading);
  EXPECT_EQ(news.left->count, 0x01234567U);
  EXPECT_EQ(news.right->count, 0xFEDCBA98U);
  const WheelNews swapped = Codec{.swap_wheels = true}.read(frame);
  EXPECT_EQ(swapped.left->count, 0xFEDCBA98U);
  EXPECT_EQ(swapped.right->count, 0x01234567U);
  EXPECT_EQ(Codec{}.read(encode_motion(Time{}, {})).use, FrameUse::kNoTravel);
  ASSERT_EQ(Codec{}.ids().size(), 1u);
  EXPECT_EQ(Codec{}.ids()[0], CanId{0x311});
}

}  // namespace
}  // namespace zenith::agilex_v2
