#include "drivers/camera/luma_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace zenith {
namespace {

constexpr std::uint32_t kBigEndian = 1u << 31;

constexpr std::array<LumaFormat, 14> kFormats = {{
    {V4L2_PIX_FMT_GREY, LumaLayout::kPlane},
    {V4L2_PIX_FMT_NV12, LumaLayout::kPlane},
    {V4L2_PIX_FMT_YUV420, LumaLayout::kPlane},
    {V4L2_PIX_FMT_NV21, LumaLayout::kPlane},
    {V4L2_PIX_FMT_YVU420, LumaLayout::kPlane},
    {V4L2_PIX_FMT_NV12M, LumaLayout::kPlane},
    {V4L2_PIX_FMT_YUV420M, LumaLayout::kPlane},
    {V4L2_PIX_FMT_YUYV, LumaLayout::kEvenBytes},
    {V4L2_PIX_FMT_UYVY, LumaLayout::kOddBytes},
    {V4L2_PIX_FMT_Y16, LumaLayout::kOddBytes},
    {V4L2_PIX_FMT_Y10, LumaLayout::kWord10},
    {V4L2_PIX_FMT_Y12, LumaLayout::kWord12},
    {V4L2_PIX_FMT_RGB24, LumaLayout::kRgb24},
    {V4L2_PIX_FMT_BGR24, LumaLayout::kBgr24},
}};

void extract_bytes(const std::uint8_t* raw, std::size_t stride, const MutableImageView& out) {
  for (int v = 0; v < out.height; ++v) {
    const std::uint8_t* from = raw + v * stride;
    std::uint8_t* to = out.row(v);
    for (int u = 0; u < out.width; ++u) to[u] = from[2 * u];
  }
}

// Values above the format's bits (a driver's mistake) saturate.
void extract_words(int bits, const std::uint8_t* raw, std::size_t stride,
                   const MutableImageView& out) {
  for (int v = 0; v < out.height; ++v) {
    const std::uint8_t* from = raw + v * stride;
    std::uint8_t* to = out.row(v);
    for (int u = 0; u < out.width; ++u) {
      const int word = from[2 * u] | (from[2 * u + 1] << 8);
      to[u] = static_cast<std::uint8_t>(std::min(word >> (bits - 8), 255));
    }
  }
}

// The luma of ITU-R BT.601, its weights in 256ths.
void extract_colours(int red, int blue, const std::uint8_t* raw, std::size_t stride,
                     const MutableImageView& out) {
  for (int v = 0; v < out.height; ++v) {
    const std::uint8_t* from = raw + v * stride;
    std::uint8_t* to = out.row(v);
    for (int u = 0; u < out.width; ++u, from += 3) {
      const int sum = 77 * from[red] + 150 * from[1] + 29 * from[blue];
      to[u] = static_cast<std::uint8_t>((sum + 128) >> 8);
    }
  }
}

}  // namespace

std::span<const LumaFormat> luma_formats() {
  return kFormats;
}

const LumaFormat* find_luma_format(std::uint32_t fourcc) {
  for (const LumaFormat& format : kFormats) {
    if (format.fourcc == fourcc) return &format;
  }
  return nullptr;
}

void extract_luma(LumaLayout layout, const std::uint8_t* raw, std::size_t stride,
                  const MutableImageView& out) {
  switch (layout) {
    case LumaLayout::kPlane:
      for (int v = 0; v < out.height; ++v) std::memcpy(out.row(v), raw + v * stride, out.width);
      return;
    case LumaLayout::kEvenBytes:
      return extract_bytes(raw, stride, out);
    case LumaLayout::kOddBytes:
      return extract_bytes(raw + 1, stride, out);
    case LumaLayout::kWord10:
      return extract_words(10, raw, stride, out);
    case LumaLayout::kWord12:
      return extract_words(12, raw, stride, out);
    case LumaLayout::kRgb24:
      return extract_colours(0, 2, raw, stride, out);
    case LumaLayout::kBgr24:
      return extract_colours(2, 0, raw, stride, out);
  }
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((fourcc >> (8 * i)) & 0x7Fu);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  while (text.size() > 1 && text.back() == ' ') text.pop_back();
  return (fourcc & kBigEndian) != 0 ? text + "-BE" : text;
}

std::uint32_t fourcc_of(const std::string& text) {
  if (text.empty() || text.size() > 4) return 0;
  std::uint32_t fourcc = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const char c = i < text.size() ? text[i] : ' ';
    fourcc |= static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << (8 * i);
  }
  return fourcc;
}

}  // namespace zenith
