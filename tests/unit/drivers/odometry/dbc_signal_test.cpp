#include "drivers/odometry/dbc_signal.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"
#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

const CanFrame kFrame = frame_of({0x123}, {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF});

double value_of(const DbcSignal& signal, const CanFrame& frame = kFrame) {
  return physical_of(signal, read_raw(signal, frame));
}

TEST(DbcSignal, IntelOrderCountsFromTheLeastSignificantBit) {
  EXPECT_EQ(value_of({.start_bit = 0, .bit_length = 16}), 0x2301);
  EXPECT_EQ(value_of({.start_bit = 8, .bit_length = 32}), double{0x89674523U});
  EXPECT_EQ(value_of({.start_bit = 4, .bit_length = 12}), 0x230);
  EXPECT_EQ(value_of({.start_bit = 13, .bit_length = 7}), 0x29);  // 001 of 0x23, 0101 of 0x45
  EXPECT_EQ(value_of({.start_bit = 40, .bit_length = 16, .value = DbcValue::kSigned}), -12885);
}

TEST(DbcSignal, MotorolaOrderStartsAtTheMostSignificantBit) {
  EXPECT_EQ(value_of({.start_bit = 7, .bit_length = 16, .motorola = true}), 0x0123);
  EXPECT_EQ(value_of({.start_bit = 15, .bit_length = 32, .motorola = true}), 0x23456789);
  EXPECT_EQ(value_of({.start_bit = 3, .bit_length = 12, .motorola = true}), 0x123);
  EXPECT_EQ(value_of({.start_bit = 9, .bit_length = 5, .motorola = true}), 0x1A);  // 11, 010
  EXPECT_EQ(
      value_of({.start_bit = 47, .bit_length = 16, .motorola = true, .value = DbcValue::kSigned}),
      -21555);
}

TEST(DbcSignal, ScalesAndShifts) {
  const DbcSignal signal = {
      .start_bit = 6, .bit_length = 15, .motorola = true, .scale = 0.01, .offset = -67.67};
  const CanFrame frame = frame_of({0x0AA}, {0x25, 0xB5});
  EXPECT_DOUBLE_EQ(value_of(signal, frame), 96.53 - 67.67);
}

TEST(DbcSignal, ReadsFloatsOfBothLengthsAndOrders) {
  const CanFrame little = frame_of({}, {0x00, 0x00, 0x00, 0x20, 0xC0});
  EXPECT_EQ(value_of({.start_bit = 8, .bit_length = 32, .value = DbcValue::kFloat32}, little),
            -2.5);
  const CanFrame big = frame_of({}, {0x00, 0xC0, 0x20, 0x00, 0x00});
  EXPECT_EQ(
      value_of({.start_bit = 15, .bit_length = 32, .motorola = true, .value = DbcValue::kFloat32},
               big),
      -2.5);
  const CanFrame wide = frame_of({}, {0xAD, 0xFA, 0x5C, 0x6D, 0x45, 0x4A, 0x93, 0x40});
  EXPECT_EQ(value_of({.start_bit = 0, .bit_length = 64, .value = DbcValue::kFloat64}, wide),
            1234.5678);
}

TEST(DbcSignal, KnowsTheBytesThatItNeeds) {
  EXPECT_EQ(bytes_needed({.start_bit = 0, .bit_length = 8}), 1u);
  EXPECT_EQ(bytes_needed({.start_bit = 1, .bit_length = 8}), 2u);
  EXPECT_EQ(bytes_needed({.start_bit = 57, .bit_length = 8}), 9u);
  EXPECT_EQ(bytes_needed({.start_bit = 7, .bit_length = 64, .motorola = true}), 8u);
  EXPECT_EQ(bytes_needed({.start_bit = 6, .bit_length = 64, .motorola = true}), 9u);
  EXPECT_EQ(bytes_needed({.start_bit = 8, .bit_length = 2, .motorola = true}), 3u);
}

TEST(DbcSignal, EncodesByteExactlyAndLeavesOtherBitsAlone) {
  CanFrame frame = frame_of({}, {0xFF, 0xFF, 0xFF});
  encode_signal({.id = {0x321}, .start_bit = 3, .bit_length = 12, .motorola = true}, 0x123, frame);
  EXPECT_EQ(frame.data, frame_of({}, {0xF1, 0x23, 0xFF}).data);
  EXPECT_EQ(id_of(frame), CanId{0x321});
  EXPECT_EQ(frame.length, 3);
  encode_signal({.id = {0x321}, .start_bit = 20, .bit_length = 8, .value = DbcValue::kSigned}, -3,
                frame);
  EXPECT_EQ(frame.data, frame_of({}, {0xF1, 0x23, 0xDF, 0x0F}).data);
  EXPECT_EQ(frame.length, 4);
}

TEST(DbcSignal, SaturatesWhatDoesNotFit) {
  const DbcSignal small = {.bit_length = 8, .value = DbcValue::kSigned};
  EXPECT_EQ(raw_of(small, 1e9), 0x7FU);
  EXPECT_EQ(raw_of(small, -1e9), 0x80U);
  EXPECT_EQ(raw_of({.bit_length = 8}, -1.0), 0U);
  EXPECT_EQ(raw_of({.bit_length = 8}, 256.0), 0xFFU);
  EXPECT_EQ(raw_of({.bit_length = 64}, 1e30), ~std::uint64_t{0});
  const DbcSignal wide = {.bit_length = 64, .value = DbcValue::kSigned};
  EXPECT_EQ(raw_of(wide, -1e30), std::uint64_t{1} << 63U);
  EXPECT_EQ(raw_of(wide, std::nan("")), 0U);
}

// Any signal that fits: what was written is read back, and nothing else changed.
TEST(DbcSignal, RandomSignalsRoundTrip) {
  const TestSeed seed;
  Random random(seed.value());
  int tried = 0;
  for (int i = 0; i < 20000; ++i) {
    DbcSignal signal;
    signal.start_bit = random.below(64);
    signal.bit_length = 1 + random.below(64);
    signal.motorola = random.below(2) == 1;
    if (bytes_needed(signal) > 8) continue;
    ++tried;
    CanFrame frame;
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random.below(256));
    const CanFrame before = frame;
    const std::uint64_t mask = ~std::uint64_t{0} >> (64 - signal.bit_length);
    const std::uint64_t raw = (std::uint64_t{random.next_u32()} << 32U | random.next_u32()) & mask;
    write_raw(signal, raw, frame);
    ASSERT_EQ(read_raw(signal, frame), raw);
    write_raw(signal, read_raw(signal, before), frame);
    ASSERT_EQ(frame.data, before.data);
  }
  EXPECT_GT(tried, 4000);
}

}  // namespace
}  // namespace zenith
