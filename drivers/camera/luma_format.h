#pragma once
// Pixel formats that hold a grey image, by their numbers in V4L2, and how to come by it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "slam/image/image.h"

namespace zenith {

enum class LumaLayout {
  kPlane,      // one byte a pixel, rows at the buffer's start: used where it lies
  kEvenBytes,  // two bytes a pixel, luma first
  kOddBytes,   // two bytes a pixel, luma second; also the high byte of 16-bit grey
  kWord10,     // 16-bit little-endian words that hold 10 bits
  kWord12,
  kRgb24,  // three bytes a pixel: red, green, blue
  kBgr24,
};

struct LumaFormat {
  std::uint32_t fourcc = 0;
  LumaLayout layout = LumaLayout::kPlane;

  std::size_t bytes_per_pixel() const {
    if (layout == LumaLayout::kPlane) return 1;
    return layout == LumaLayout::kRgb24 || layout == LumaLayout::kBgr24 ? 3 : 2;
  }
  // That rows of `stride` bytes need from the first pixel to the last.
  std::size_t needed_bytes(int width, int height, std::size_t stride) const {
    return stride * (height - 1) + bytes_per_pixel() * width;
  }
};

// All that can be read, the cheapest first.
std::span<const LumaFormat> luma_formats();

// Null for what cannot be read (compressed, Bayer, other colour without a luma channel).
const LumaFormat* find_luma_format(std::uint32_t fourcc);

// `raw` in the given layout, `stride` bytes from row to row, into `out`. No heap.
void extract_luma(LumaLayout layout, const std::uint8_t* raw, std::size_t stride,
                  const MutableImageView& out);

// "YUYV"; unprintable characters as '?', trailing blanks cut.
std::string fourcc_text(std::uint32_t fourcc);
// 0 when `text` is not one to four characters; shorter ones are filled up with blanks ("Y10").
std::uint32_t fourcc_of(const std::string& text);

}  // namespace zenith
