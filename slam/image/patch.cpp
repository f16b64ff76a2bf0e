#include "slam/image/patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/kernels/image/image_kernels.h"

namespace zenith {
namespace {

static_assert(kPatchSize == kPatchSide && kCompactLength == kCompactValues);

constexpr float kMinContrast = 1.0F;  // grey levels, root mean square

// Rows of the orthonormal DCT-II of length 16, frequencies 0..7, and the zigzag of the 32
// coefficients kept: by rising sum of the two frequencies, the constant one left out.
DctTable make_dct() {
  DctTable table = {};
  for (int k = 0; k < kDctKept; ++k) {
    const double norm = k == 0 ? std::sqrt(1.0 / kPatchSize) : std::sqrt(2.0 / kPatchSize);
    for (int i = 0; i < kPatchSize; ++i) {
      const auto value =
          static_cast<float>(norm * std::cos(std::numbers::pi * (i + 0.5) * k / kPatchSize));
      table.by_frequency[k][i] = value;
      table.by_place[i][k] = value;
    }
  }
  int n = 0;
  for (int sum = 1; n < kCompactLength; ++sum) {
    for (int k = 0; k <= sum && n < kCompactLength; ++k) {
      const int fu = sum % 2 == 0 ? k : sum - k;
      if (fu > 7 || sum - fu > 7) continue;
      table.order[n][0] = static_cast<std::uint8_t>(fu);
      table.order[n][1] = static_cast<std::uint8_t>(sum - fu);
      ++n;
    }
  }
  return table;
}

const DctTable kDct = make_dct();

}  // namespace

float patch_orientation(const ImageView& image, float u_px, float v_px) {
  const int cu = static_cast<int>(std::lround(u_px));
  const int cv = static_cast<int>(std::lround(v_px));
  const float du = u_px - static_cast<float>(cu);
  const float dv = v_px - static_cast<float>(cv);
  const CentroidSums s = image_kernels().centroid(image.data, image.stride, cu, cv, du, dv);
  const float mean = s.i / s.w;
  return std::atan2(s.y - mean * s.wy, s.x - mean * s.wx);
}

Patch sample_patch(const ImageView& image, float u_px, float v_px, float orientation_rad) {
  Patch patch;
  patch.inverse_norm =
      image_kernels().patch(image.data, image.stride, u_px, v_px, std::cos(orientation_rad),
                            std::sin(orientation_rad), kMinContrast, patch.values.data());
  return patch;
}

CompactPatch compact(const Patch& patch) {
  CompactPatch out;
  if (patch.inverse_norm > 0.0F) {
    out.inverse_norm = image_kernels().compact(kDct, patch.values.data(), out.values.data());
  }
  return out;
}

Outline outline(const Patch& patch, const CompactPatch& compact) {
  Outline out;
  if (patch.inverse_norm <= 0.0F) return out;
  // The patch's coefficients, unrounded, along the compact form and beside it.
  double along = 0.0;
  double within = 0.0;
  for (std::size_t n = 0; n < kCompactLength; ++n) {
    double coefficient = 0.0;
    for (std::size_t y = 0; y < kPatchSize; ++y) {
      double row = 0.0;
      for (std::size_t x = 0; x < kPatchSize; ++x) {
        row += static_cast<double>(kDct.by_frequency[kDct.order[n][0]][x]) *
               patch.values[y * kPatchSize + x];
      }
      coefficient += static_cast<double>(kDct.by_frequency[kDct.order[n][1]][y]) * row;
    }
    coefficient *= static_cast<double>(patch.inverse_norm);
    along += coefficient * compact.values[n] * static_cast<double>(compact.inverse_norm);
    within += coefficient * coefficient;
  }
  // Floats are rounded here and in the search, in the sixth digit.
  constexpr double kRounding = 1e-5;
  out.scale = static_cast<float>(along) * compact.inverse_norm;
  out.rest = static_cast<float>(std::sqrt(std::max(0.0, 1.0 - along * along)) + kRounding);
  out.off = static_cast<float>(std::sqrt(std::max(0.0, within - along * along)) + kRounding);
  return out;
}

CompactPatch compact_from(const std::array<std::int8_t, kCompactLength>& values) {
  CompactPatch out{values, 0.0F};
  int sum = 0;
  for (const int x : values) sum += x * x;
  if (sum > 0) out.inverse_norm = 1.0F / std::sqrt(static_cast<float>(sum));
  return out;
}

}  // namespace zenith
