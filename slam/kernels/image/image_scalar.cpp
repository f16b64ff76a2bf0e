// The specification of the image kernels.

#include <algorithm>
#include <cmath>

#include "slam/kernels/image/image_kernels.h"

namespace zenith {
namespace {

void remap(const std::uint8_t* frame, std::ptrdiff_t stride, const RemapEntry* entries, int count,
           std::uint8_t* out) {
  for (int i = 0; i < count; ++i) {
    const RemapEntry& e = entries[i];
    const std::uint8_t* p = frame + e.v * stride + e.u;
    const int wu = e.weight_u;
    const int wv = e.weight_v;
    if (e.inside == 0) {
      out[i] = 0;
      continue;
    }
    const int top = p[0] * (128 - wu) + p[1] * wu;
    const int bottom = p[stride] * (128 - wu) + p[stride + 1] * wu;
    out[i] = static_cast<std::uint8_t>((top * (128 - wv) + bottom * wv + 8192) >> 14);
  }
}

// --- corners ---

constexpr float kHarrisK = 0.04F;
constexpr float kWindow[4] = {1.0F / 64, 6.0F / 64, 15.0F / 64, 20.0F / 64};  // from outside

// Products of Scharr's gradients into three planes; the outermost pixels are 0.
void gradient_products(const std::uint8_t* image, std::ptrdiff_t stride, int n, float* xx,
                       float* xy, float* yy) {
  for (int v = 1; v < n - 1; ++v) {
    const std::uint8_t* a = image + (v - 1) * stride;
    const std::uint8_t* b = a + stride;
    const std::uint8_t* c = b + stride;
    const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(v) * n;
    xx[o] = xy[o] = yy[o] = 0.0F;
    xx[o + n - 1] = xy[o + n - 1] = yy[o + n - 1] = 0.0F;
    for (int u = 1; u < n - 1; ++u) {
      const int gx =
          3 * (a[u + 1] - a[u - 1]) + 10 * (b[u + 1] - b[u - 1]) + 3 * (c[u + 1] - c[u - 1]);
      const int gy = 3 * (c[u - 1] - a[u - 1]) + 10 * (c[u] - a[u]) + 3 * (c[u + 1] - a[u + 1]);
      const float fx = static_cast<float>(gx) * (1.0F / 32);
      const float fy = static_cast<float>(gy) * (1.0F / 32);
      xx[o + u] = fx * fx;
      xy[o + u] = fx * fy;
      yy[o + u] = fy * fy;
    }
  }
}

// The binomial window at p, its values `step` apart.
float window(const float* p, std::ptrdiff_t step) {
  return kWindow[0] * (p[-3 * step] + p[3 * step]) + kWindow[1] * (p[-2 * step] + p[2 * step]) +
         kWindow[2] * (p[-step] + p[step]) + kWindow[3] * p[0];
}

void harris(const std::uint8_t* image, std::ptrdiff_t stride, int n, float min_eigenvalue,
            float* response, float* scratch) {
  const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(n) * n;
  float* products[3] = {scratch, scratch + plane, scratch + 2 * plane};
  float* smooth[3] = {scratch + 3 * plane, scratch + 3 * plane + n, scratch + 3 * plane + 2 * n};
  gradient_products(image, stride, n, products[0], products[1], products[2]);
  std::fill_n(response, plane, 0.0F);
  for (int v = kHarrisEdge; v < n - kHarrisEdge; ++v) {
    // Along the columns, then along the row.
    for (int k = 0; k < 3; ++k) {
      for (int u = 1; u < n - 1; ++u) smooth[k][u] = window(products[k] + v * n + u, n);
    }
    for (int u = kHarrisEdge; u < n - kHarrisEdge; ++u) {
      const float a = window(smooth[0] + u, 1);
      const float b = window(smooth[1] + u, 1);
      const float c = window(smooth[2] + u, 1);
      const float r = a * c - b * b - kHarrisK * (a + c) * (a + c);
      // Smaller eigenvalue >= min, without the root: det(A - min I) >= 0, tr >= 2 min.
      const bool strong = (a - min_eigenvalue) * (c - min_eigenvalue) - b * b >= 0.0F &&
                          a + c >= 2.0F * min_eigenvalue;
      if (strong && r > 0.0F) response[v * n + u] = r;
    }
  }
}

int peaks(const float* response, int n, int border, std::int32_t* places, int room) {
  int count = 0;
  for (int v = border; v < n - border && count + n <= room; ++v) {
    const float* r = response + static_cast<std::ptrdiff_t>(v) * n;
    for (int u = border; u < n - border; ++u) {
      const float m = r[u];
      const bool before = m >= r[u - 1] && m >= r[u - n - 1] && m >= r[u - n] && m >= r[u - n + 1];
      const bool after = m > r[u + 1] && m > r[u + n - 1] && m > r[u + n] && m > r[u + n + 1];
      if (m > 0.0F && before && after) places[count++] = v * n + u;
    }
  }
  return count;
}

// --- patches ---

// Sums over columns are kept apart, sixteen of them, and added up at the end in this order.
float total(const float (&lanes)[16]) {
  float sum[16];
  for (int i = 0; i < 16; ++i) sum[i] = lanes[i];
  for (int half = 8; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  }
  return sum[0];
}

CentroidSums centroid(const std::uint8_t* image, std::ptrdiff_t stride, int cu, int cv, float du,
                      float dv) {
  // A weight that falls to zero at the rim keeps the direction steady when pixels enter the disc.
  float w[16] = {}, wx[16] = {}, wy[16] = {}, i[16] = {}, ix[16] = {}, iy[16] = {};
  for (int y = -kPatchDisc; y <= kPatchDisc; ++y) {
    const std::uint8_t* row = image + (cv + y) * stride + cu;
    const float fy = static_cast<float>(y) - dv;
    for (int x = -kPatchDisc; x <= kPatchDisc; ++x) {
      const float fx = static_cast<float>(x) - du;
      const float weight =
          std::max(1.0F - (fx * fx + fy * fy) * (1.0F / (kPatchDisc * kPatchDisc)), 0.0F);
      const float grey = weight * static_cast<float>(row[x]);
      const int lane = (x + kPatchDisc) % 16;
      w[lane] += weight;
      wx[lane] += weight * fx;
      wy[lane] += weight * fy;
      i[lane] += grey;
      ix[lane] += grey * fx;
      iy[lane] += grey * fy;
    }
  }
  return {total(w), total(wx), total(wy), total(i), total(ix), total(iy)};
}

// int8 values of largest magnitude 127 in proportion to `values`; returns 1 / |result|.
float quantise(const float* values, int count, std::int8_t* out) {
  float largest = 0.0F;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(values[i]));
  if (largest <= 0.0F) {
    std::fill_n(out, count, std::int8_t{0});
    return 0.0F;
  }
  const float scale = 127.0F / largest;
  int sum = 0;
  for (int i = 0; i < count; ++i) {
    const int q = static_cast<int>(std::lround(values[i] * scale));
    out[i] = static_cast<std::int8_t>(q);
    sum += q * q;
  }
  return 1.0F / std::sqrt(static_cast<float>(sum));
}

float patch(const std::uint8_t* image, std::ptrdiff_t stride, float u0, float v0, float c, float s,
            float min_contrast, std::int8_t* out) {
  constexpr float kHalf = 0.5F * (kPatchSide - 1);
  float values[kPatchSide * kPatchSide];
  float sums[16] = {};
  for (int y = 0; y < kPatchSide; ++y) {
    for (int x = 0; x < kPatchSide; ++x) {
      const float px = static_cast<float>(x) - kHalf;
      const float py = static_cast<float>(y) - kHalf;
      const float u = u0 + c * px - s * py;
      const float v = v0 + s * px + c * py;
      const int iu = static_cast<int>(u);
      const int iv = static_cast<int>(v);
      const float wu = u - static_cast<float>(iu);
      const float wv = v - static_cast<float>(iv);
      const std::uint8_t* a = image + iv * stride + iu;
      const std::uint8_t* b = a + stride;
      const float top = static_cast<float>(a[0]) + wu * static_cast<float>(a[1] - a[0]);
      const float bottom = static_cast<float>(b[0]) + wu * static_cast<float>(b[1] - b[0]);
      const float value = top + wv * (bottom - top);
      values[y * kPatchSide + x] = value;
      sums[x] += value;
    }
  }
  const float mean = total(sums) * (1.0F / (kPatchSide * kPatchSide));
  float energy[16] = {};
  for (int i = 0; i < kPatchSide * kPatchSide; ++i) {
    values[i] -= mean;
    energy[i % 16] += values[i] * values[i];
  }
  if (total(energy) < min_contrast * min_contrast * (kPatchSide * kPatchSide)) {
    std::fill_n(out, kPatchSide * kPatchSide, std::int8_t{0});
    return 0.0F;
  }
  return quantise(values, kPatchSide * kPatchSide, out);
}

float compact(const DctTable& dct, const std::int8_t* patch, std::int8_t* values) {
  float rows[kPatchSide][kDctKept];  // [y][frequency of u]
  for (int y = 0; y < kPatchSide; ++y) {
    for (int k = 0; k < kDctKept; ++k) {
      float sum = 0.0F;
      for (int x = 0; x < kPatchSide; ++x) {
        sum += dct.by_frequency[k][x] * static_cast<float>(patch[y * kPatchSide + x]);
      }
      rows[y][k] = sum;
    }
  }
  float coefficients[kCompactValues];
  for (int n = 0; n < kCompactValues; ++n) {
    float sum = 0.0F;
    for (int y = 0; y < kPatchSide; ++y) {
      sum += dct.by_frequency[dct.order[n][1]][y] * rows[y][dct.order[n][0]];
    }
    coefficients[n] = sum;
  }
  return quantise(coefficients, kCompactValues, values);
}

}  // namespace

const ImageTable kImageScalar = {Isa::kScalar, remap, harris, peaks, centroid, patch, compact};

}  // namespace zenith
