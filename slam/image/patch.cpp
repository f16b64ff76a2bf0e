#include "slam/image/patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace zenith {
namespace {

constexpr int kRadius = 8;
constexpr float kMinContrast = 1.0F;  // grey levels, root mean square

// int8 values of largest magnitude 127 in proportion to `values`; returns 1 / |result|.
float quantise(std::span<const float> values, std::span<std::int8_t> out) {
  float largest = 0.0F;
  for (const float x : values) largest = std::max(largest, std::abs(x));
  if (largest <= 0.0F) {
    std::fill(out.begin(), out.end(), std::int8_t{0});
    return 0.0F;
  }
  const float scale = 127.0F / largest;
  int sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int q = static_cast<int>(std::lround(values[i] * scale));
    out[i] = static_cast<std::int8_t>(q);
    sum += q * q;
  }
  return 1.0F / std::sqrt(static_cast<float>(sum));
}

// Rows of the orthonormal DCT-II of length 16, frequencies 0..7, and the zigzag of the 32
// coefficients kept: by rising sum of the two frequencies, the constant one left out.
struct DctTable {
  std::array<std::array<float, kPatchSize>, 8> basis = {};
  std::array<std::array<int, 2>, kCompactLength> order = {};

  DctTable() {
    for (int k = 0; k < 8; ++k) {
      const double norm = k == 0 ? std::sqrt(1.0 / kPatchSize) : std::sqrt(2.0 / kPatchSize);
      for (int i = 0; i < kPatchSize; ++i) {
        basis[k][i] =
            static_cast<float>(norm * std::cos(std::numbers::pi * (i + 0.5) * k / kPatchSize));
      }
    }
    std::size_t n = 0;
    for (int sum = 1; n < kCompactLength; ++sum) {
      for (int k = 0; k <= sum && n < kCompactLength; ++k) {
        const int fu = sum % 2 == 0 ? k : sum - k;
        if (fu > 7 || sum - fu > 7) continue;
        order[n++] = {fu, sum - fu};
      }
    }
  }
};

const DctTable kDct;

}  // namespace

float patch_orientation(const ImageView& image, float u_px, float v_px) {
  const int cu = static_cast<int>(std::lround(u_px));
  const int cv = static_cast<int>(std::lround(v_px));
  const float du = u_px - static_cast<float>(cu);
  const float dv = v_px - static_cast<float>(cv);
  // A weight that falls to zero at the rim keeps the direction steady when pixels enter the disc.
  float sum_w = 0.0F;
  float sum_i = 0.0F;
  float sum_x = 0.0F;
  float sum_y = 0.0F;
  float sum_wx = 0.0F;
  float sum_wy = 0.0F;
  for (int y = -kRadius; y <= kRadius; ++y) {
    const std::uint8_t* row = image.row(cv + y);
    for (int x = -kRadius; x <= kRadius; ++x) {
      const float fx = static_cast<float>(x) - du;
      const float fy = static_cast<float>(y) - dv;
      const float w = 1.0F - (fx * fx + fy * fy) * (1.0F / (kRadius * kRadius));
      if (w <= 0.0F) continue;
      const float i = w * static_cast<float>(row[cu + x]);
      sum_w += w;
      sum_wx += w * fx;
      sum_wy += w * fy;
      sum_i += i;
      sum_x += i * fx;
      sum_y += i * fy;
    }
  }
  const float mean = sum_i / sum_w;
  return std::atan2(sum_y - mean * sum_wy, sum_x - mean * sum_wx);
}

Patch sample_patch(const ImageView& image, float u_px, float v_px, float orientation_rad) {
  const float c = std::cos(orientation_rad);
  const float s = std::sin(orientation_rad);
  constexpr float kHalf = 0.5F * (kPatchSize - 1);
  std::array<float, kPatchLength> values;
  float sum = 0.0F;
  for (int y = 0; y < kPatchSize; ++y) {
    for (int x = 0; x < kPatchSize; ++x) {
      const float px = static_cast<float>(x) - kHalf;
      const float py = static_cast<float>(y) - kHalf;
      const float u = u_px + c * px - s * py;
      const float v = v_px + s * px + c * py;
      const int iu = static_cast<int>(u);
      const int iv = static_cast<int>(v);
      const float wu = u - static_cast<float>(iu);
      const float wv = v - static_cast<float>(iv);
      const std::uint8_t* a = image.row(iv) + iu;
      const std::uint8_t* b = image.row(iv + 1) + iu;
      const float top = static_cast<float>(a[0]) + wu * static_cast<float>(a[1] - a[0]);
      const float bottom = static_cast<float>(b[0]) + wu * static_cast<float>(b[1] - b[0]);
      const float value = top + wv * (bottom - top);
      values[static_cast<std::size_t>(y * kPatchSize + x)] = value;
      sum += value;
    }
  }
  const float mean = sum / kPatchLength;
  float energy = 0.0F;
  for (float& value : values) {
    value -= mean;
    energy += value * value;
  }
  Patch patch;
  if (energy < kMinContrast * kMinContrast * kPatchLength) return patch;
  patch.inverse_norm = quantise(values, patch.values);
  return patch;
}

CompactPatch compact(const Patch& patch) {
  std::array<std::array<float, 8>, kPatchSize> rows;  // [y][fu]
  for (std::size_t y = 0; y < kPatchSize; ++y) {
    for (std::size_t k = 0; k < 8; ++k) {
      float sum = 0.0F;
      for (std::size_t x = 0; x < kPatchSize; ++x) {
        sum += kDct.basis[k][x] * static_cast<float>(patch.values[y * kPatchSize + x]);
      }
      rows[y][k] = sum;
    }
  }
  std::array<float, kCompactLength> coefficients;
  for (std::size_t n = 0; n < kCompactLength; ++n) {
    const auto fu = static_cast<std::size_t>(kDct.order[n][0]);
    const auto fv = static_cast<std::size_t>(kDct.order[n][1]);
    float sum = 0.0F;
    for (std::size_t y = 0; y < kPatchSize; ++y) sum += kDct.basis[fv][y] * rows[y][fu];
    coefficients[n] = sum;
  }
  CompactPatch out;
  if (patch.inverse_norm > 0.0F) out.inverse_norm = quantise(coefficients, out.values);
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
