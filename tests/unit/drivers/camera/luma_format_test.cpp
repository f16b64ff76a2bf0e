#include "drivers/camera/luma_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <array>
#include <vector>

namespace zenith {
namespace {

constexpr int kWidth = 3;
constexpr int kHeight = 2;
constexpr std::size_t kPadding = 1;

std::vector<std::uint8_t> extract(LumaLayout layout, std::size_t bytes_per_pixel) {
  const std::size_t stride = kWidth * bytes_per_pixel + kPadding;
  std::vector<std::uint8_t> raw(stride * kHeight);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint8_t>(i + 1);
  std::vector<std::uint8_t> luma(kWidth * kHeight);
  extract_luma(layout, raw.data(), stride, {luma.data(), kWidth, kHeight, kWidth});
  return luma;
}

using Bytes = std::vector<std::uint8_t>;

TEST(LumaFormat, ExtractsByLayoutAndSkipsPadding) {
  EXPECT_EQ(extract(LumaLayout::kPlane, 1), (Bytes{1, 2, 3, 5, 6, 7}));
  EXPECT_EQ(extract(LumaLayout::kEvenBytes, 2), (Bytes{1, 3, 5, 8, 10, 12}));
  EXPECT_EQ(extract(LumaLayout::kOddBytes, 2), (Bytes{2, 4, 6, 9, 11, 13}));
}

TEST(LumaFormat, ScalesWordsAndSaturatesExcessBits) {
  const std::array<std::uint8_t, 8> raw = {0xFF, 0x03, 0x04, 0x00, 0x00, 0x02, 0xFF, 0xFF};
  std::array<std::uint8_t, 4> luma = {};
  extract_luma(LumaLayout::kWord10, raw.data(), raw.size(), {luma.data(), 4, 1, 4});
  EXPECT_EQ(luma, (std::array<std::uint8_t, 4>{255, 1, 128, 255}));
  extract_luma(LumaLayout::kWord12, raw.data(), raw.size(), {luma.data(), 4, 1, 4});
  EXPECT_EQ(luma, (std::array<std::uint8_t, 4>{63, 0, 32, 255}));
}

TEST(LumaFormat, WeighsColours) {
  const std::array<std::uint8_t, 12> raw = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  std::array<std::uint8_t, 4> luma = {};
  extract_luma(LumaLayout::kRgb24, raw.data(), raw.size(), {luma.data(), 4, 1, 4});
  EXPECT_EQ(luma, (std::array<std::uint8_t, 4>{77, 149, 29, 255}));
  extract_luma(LumaLayout::kBgr24, raw.data(), raw.size(), {luma.data(), 4, 1, 4});
  EXPECT_EQ(luma, (std::array<std::uint8_t, 4>{29, 149, 77, 255}));
}

TEST(LumaFormat, LastRowNeedsNoPadding) {
  const LumaFormat yuyv = *find_luma_format(V4L2_PIX_FMT_YUYV);
  EXPECT_EQ(yuyv.needed_bytes(4, 3, 10), 28u);
  EXPECT_EQ(find_luma_format(V4L2_PIX_FMT_RGB24)->needed_bytes(4, 3, 16), 44u);
  EXPECT_EQ(find_luma_format(V4L2_PIX_FMT_GREY)->needed_bytes(4, 3, 10), 24u);
}

TEST(LumaFormat, KnowsNoCompressedOrRawFormat) {
  for (const std::uint32_t fourcc : {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_H264, V4L2_PIX_FMT_RGB565,
                                     V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_Y16_BE}) {
    EXPECT_EQ(find_luma_format(fourcc), nullptr) << fourcc_text(fourcc);
  }
}

TEST(LumaFormat, FourccAsTextAndBack) {
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_YUYV), "YUYV");
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Y10), "Y10");
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Y16_BE), "Y16-BE");
  EXPECT_EQ(fourcc_text(0x01020304), "????");
  EXPECT_EQ(fourcc_of("GREY"), V4L2_PIX_FMT_GREY);
  EXPECT_EQ(fourcc_of("Y10"), V4L2_PIX_FMT_Y10);
  EXPECT_EQ(fourcc_of(""), 0u);
  EXPECT_EQ(fourcc_of("GREYS"), 0u);
}

}  // namespace
}  // namespace zenith
