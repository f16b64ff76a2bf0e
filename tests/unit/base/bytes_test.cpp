#include "platform/base/bytes.h"

#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(Bytes, IsLittleEndianWhateverTheMachine) {
  std::array<std::uint8_t, 64> room = {};
  ByteWriter out(room);
  out.u8(0x01).u16(0x0302).u32(0x07060504).i64(-2).f64(1.0).text("hi");
  ASSERT_FALSE(out.failed());
  const std::vector<std::uint8_t> expected = {1,   2,    3,    4,   5,   6, 7, 254, 255, 255,
                                              255, 255,  255,  255, 255, 0, 0, 0,   0,   0,
                                              0,   0xF0, 0x3F, 2,   0,   0, 0, 'h', 'i'};
  EXPECT_EQ(std::vector<std::uint8_t>(room.begin(), room.begin() + out.size()), expected);
  ByteReader in{std::span(room).first(out.size())};
  EXPECT_EQ(in.u8(), 0x01);
  EXPECT_EQ(in.u16(), 0x0302);
  EXPECT_EQ(in.u32(), 0x07060504U);
  EXPECT_EQ(in.i64(), -2);
  EXPECT_EQ(in.f64(), 1.0);
  EXPECT_EQ(in.text(), "hi");
  EXPECT_TRUE(in.done());
}

TEST(Bytes, WhatDoesNotFitSpoilsTheWhole) {
  std::array<std::uint8_t, 6> room = {};
  ByteWriter out(room);
  out.u32(1).u32(2);
  EXPECT_TRUE(out.failed());
  EXPECT_EQ(out.size(), 4u) << "nothing of the one that did not fit";
}

TEST(Bytes, WhatIsNotThereReadsAsNothing) {
  const std::array<std::uint8_t, 5> data = {0xFF, 0xFF, 0xFF, 0xFF, 1};
  ByteReader text(data);
  EXPECT_EQ(text.text(), "") << "a length beyond the end";
  EXPECT_TRUE(text.failed());
  ByteReader number(data);
  EXPECT_EQ(number.u64(), 0u);
  EXPECT_TRUE(number.failed());
  ByteReader half(data);
  half.u32();
  EXPECT_FALSE(half.done()) << "one byte is left";
}

}  // namespace
}  // namespace zenith
