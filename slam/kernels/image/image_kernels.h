#pragma once
// What is done with pixels: rectification, corner response, local maxima, patches, their compact
// form. The models and their sources: slam/image/{rectify,corners,patch}.h.
//
// Images are 8-bit grey, `stride` bytes from row to row. Integer results are exact; floats are
// computed by the same operations in the same order on every instruction set, without fused
// multiply-adds, so all paths give the same bits. Nothing outside the stated rectangles is read.
//
// No heap, no state.

#include <cstddef>
#include <cstdint>

#include "platform/base/isa.h"

namespace zenith {

// Where a rectified pixel comes from: the upper left one of four, and bilinear weights in 1/128.
struct RemapEntry {
  std::uint16_t u = 0;
  std::uint16_t v = 0;
  std::uint8_t weight_u = 0;
  std::uint8_t weight_v = 0;
  std::uint8_t inside = 0;  // 0: nothing there; the pixel is 0
};
static_assert(sizeof(RemapEntry) == 8);

// Kernels read this many bytes at once: from u = width - kRemapReads + 1 on there is nothing inside
// the last two rows.
inline constexpr int kRemapReads = 4;

// No response this near to the edge: three pixels of window, one of gradient.
inline constexpr int kHarrisEdge = 4;
inline constexpr int kMaxHarrisSize = 1024;
// Floats of scratch memory for an image of size x size.
constexpr std::size_t harris_scratch(int size) {
  return 3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size + 1) + 1024;
}

// A patch's corner is at least this far from every edge of the image.
inline constexpr int kPatchMargin = 12;
inline constexpr int kPatchSide = 16;
inline constexpr int kPatchDisc = 8;  // radius of the disc that tells the direction
inline constexpr int kDctKept = 8;    // frequencies in each direction
inline constexpr int kCompactValues = 32;

// Weighted sums over the disc: of the weights, of grey values, and of both with x and y.
struct CentroidSums {
  float w, wx, wy, i, x, y;
};

// DCT-II of length 16, the first eight frequencies, both ways round; and which (u, v) are kept.
struct DctTable {
  alignas(64) float by_frequency[kDctKept][kPatchSide];
  alignas(64) float by_place[kPatchSide][kDctKept];
  std::uint8_t order[kCompactValues][2];
};

struct ImageTable {
  Isa isa;

  // out[i] = ((p00 (128-wu) + p01 wu) (128-wv) + (p10 (128-wu) + p11 wu) wv + 8192) >> 14. `stride`
  // of the frame below 32768. `count` entries.
  void (*remap)(const std::uint8_t* frame, std::ptrdiff_t stride, const RemapEntry* entries,
                int count, std::uint8_t* out);

  // The Harris response of slam/image/corners.h, size x size floats.
  void (*harris)(const std::uint8_t* image, std::ptrdiff_t stride, int size, float min_eigenvalue,
                 float* response, float* scratch);

  // Places v * size + u of local maxima of 3 x 3 above 0, at least `border` from the edge, row by
  // row; of equal neighbours the last. Returns how many; stops when there is no room for one row
  // more.
  int (*peaks)(const float* response, int size, int border, std::int32_t* places, int room);

  // Around pixel (cu, cv), whose centre lies (du, dv) before the corner.
  CentroidSums (*centroid)(const std::uint8_t* image, std::ptrdiff_t stride, int cu, int cv,
                           float du, float dv);

  // The patch around (u, v), turned by (cos, sin), made zero-mean, as int8 of largest magnitude
  // 127. Returns 1 / norm of the int8 values; 0 and zeros where its contrast (RMS, grey levels) is
  // below.
  float (*patch)(const std::uint8_t* image, std::ptrdiff_t stride, float u, float v, float cos,
                 float sin, float min_contrast, std::int8_t* values);

  // Its low DCT coefficients, quantised the same way. Returns 1 / norm, 0 for zeros.
  float (*compact)(const DctTable& dct, const std::int8_t* patch, std::int8_t* values);
};

const ImageTable& image_table(Isa isa);
const ImageTable& image_kernels();  // of the instruction set in use

extern const ImageTable kImageScalar;
extern const ImageTable kImageSse41;
extern const ImageTable kImageAvx2;
extern const ImageTable kImageAvx512;
extern const ImageTable kImageNeon;

}  // namespace zenith
