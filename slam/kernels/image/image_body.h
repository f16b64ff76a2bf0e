#pragma once
// The image kernels over lanes. For the kernels' own files: see lanes.h. What they compute:
// image_scalar.cpp.
//
// Ops: kLanes; bits(mask): a bit for each lane; gather(base, offsets): 32 bits from each place;
//   madd(a, b): low halves' product plus high halves' product, halves being signed 16 bits;
//   shorts(from): kLanes pixels; ints(shorts).

#include "slam/kernels/image/image_kernels.h"
#include "slam/kernels/lanes.h"

namespace zenith {
namespace {

template <typename Ops>
struct ImageKernels {
  static constexpr int N = Ops::kLanes;
  using F = Floats<N>;
  using I = Ints<N>;

  static void remap(const std::uint8_t* frame, std::ptrdiff_t stride, const RemapEntry* entries,
                    int count, std::uint8_t* out) {
    const I step = I{} + (static_cast<std::int32_t>(stride) << 16 | 1);
    int i = 0;
    for (; i + N <= count; i += N) {
      I uv;
      I weights;
      Ops::deinterleave(entries + i, uv, weights);
      const I at = Ops::madd(uv, step);
      const I top = pair(Ops::gather(frame, at));
      const I bottom = pair(Ops::gather(frame + stride, at));
      const I wu = weight_pair(weights & 255);
      const I wv = weight_pair((weights >> 8) & 255);
      const I both = Ops::madd(top, wu) | Ops::madd(bottom, wu) << 16;
      const I grey = (Ops::madd(both, wv) + 8192) >> 14;
      const I inside = (weights & 0x00ff0000) != 0;
      const Bytes<N> bytes = __builtin_convertvector(grey & inside, Bytes<N>);
      __builtin_memcpy(out + i, &bytes, N);
    }
    if (i < count) kImageScalar.remap(frame, stride, entries + i, count - i, out + i);
  }
  // The first two of four bytes, 16 bits each.
  static ZENITH_INLINE I pair(const I& bytes) { return (bytes & 0xff) | (bytes & 0xff00) << 8; }
  // 128 - w below, w above.
  static ZENITH_INLINE I weight_pair(const I& w) { return (w << 16) - w + 128; }

  // --- corners ---

  static ZENITH_INLINE Shorts<N> shorts(const std::uint8_t* from) { return Ops::shorts(from); }
  static ZENITH_INLINE F floats(const Shorts<N>& s) {
    return __builtin_convertvector(Ops::ints(s), F);
  }
  // Calls work(u) for blocks that cover [begin, end), the last one overlapping the one before.
  template <typename Work>
  static ZENITH_INLINE void cover(int begin, int end, Work work) {
    int u = begin;
    for (; u + N <= end; u += N) work(u);
    if (u < end) work(end - N);
  }

  // In units of 32 grey levels a pixel: the window makes up for it.
  static ZENITH_INLINE void gradient_row(const std::uint8_t* b, std::ptrdiff_t stride, int n,
                                         float* const (&products)[3]) {
    const std::uint8_t* a = b - stride;
    const std::uint8_t* c = b + stride;
    cover(
        1, n - 1, [&](int u) __attribute__((always_inline)) {
          const Shorts<N> a0 = shorts(a + u - 1);
          const Shorts<N> a2 = shorts(a + u + 1);
          const Shorts<N> c0 = shorts(c + u - 1);
          const Shorts<N> c2 = shorts(c + u + 1);
          const Shorts<N> b0 = shorts(b + u - 1);
          const Shorts<N> b2 = shorts(b + u + 1);
          const Shorts<N> a1 = shorts(a + u);
          const Shorts<N> c1 = shorts(c + u);
          // The same integers as (3 (a2-a0) + 10 (b2-b0) + 3 (c2-c0)), below 2^12.
          const Shorts<N> diagonal = c2 - a0;
          const Shorts<N> other = a2 - c0;
          const F fx = floats(3 * (diagonal + other) + 10 * (b2 - b0));
          const F fy = floats(3 * (diagonal - other) + 10 * (c1 - a1));
          // Exact, being integers below 2^24.
          store<N>(products[0] + u, fx * fx);
          store<N>(products[1] + u, fx * fy);
          store<N>(products[2] + u, fy * fy);
        });
  }

  // The binomial window over seven values. With kDown = 32 * 32, of products in gradient_row()'s
  // units: powers of two do not change how sums are rounded.
  template <int kDown>
  static ZENITH_INLINE F window(const F& m3, const F& m2, const F& m1, const F& m0, const F& p1,
                                const F& p2, const F& p3) {
    return (1.0F / (64 * kDown)) * (m3 + p3) + (6.0F / (64 * kDown)) * (m2 + p2) +
           (15.0F / (64 * kDown)) * (m1 + p1) + (20.0F / (64 * kDown)) * m0;
  }
  static ZENITH_INLINE F window_along(const float* p) {
    return window<1>(load<N>(p - 3), load<N>(p - 2), load<N>(p - 1), load<N>(p), load<N>(p + 1),
                     load<N>(p + 2), load<N>(p + 3));
  }

  // What harris() keeps: products of seven rows, and one row of them smoothed along the columns.
  // Column 1 is where vectors are aligned.
  struct HarrisRows {
    float* rows[8][3];
    HarrisRows(float* scratch, int n) {
      const auto misplaced = reinterpret_cast<std::uintptr_t>(scratch) / 4 % 16;
      float* at = scratch + (16 - misplaced) + 15;
      for (auto& row : rows) {
        for (float*& plane : row) {
          plane = at;
          at += (n + 15) / 16 * 16;
        }
      }
    }
    ZENITH_INLINE float* const (&products(int v))[3] { return rows[v % 7]; }
    ZENITH_INLINE float* const (&smooth())[3] { return rows[7]; }
  };

  // Smoothes row v along its columns. `strong[k]`: whether block k from column 1 on has a trace
  // from which a corner could come; the window's weights add up to one, so smoothing makes no
  // trace larger than all of its neighbours'.
  static ZENITH_INLINE void smooth_columns(HarrisRows& kept, int v, int n, float min_trace,
                                           bool* strong) {
    float* const(&to)[3] = kept.smooth();
    const float* from[3][7];
    for (int k = 0; k < 3; ++k) {
      for (int row = 0; row < 7; ++row) from[k][row] = kept.products(v - 3 + row)[k];
    }
    cover(
        1, n - 1, [&](int u) __attribute__((always_inline)) {
          F sums[3];
          for (int k = 0; k < 3; ++k) {
            const float* const* r = from[k];
            sums[k] = window<1024>(load<N>(r[0] + u), load<N>(r[1] + u), load<N>(r[2] + u),
                                   load<N>(r[3] + u), load<N>(r[4] + u), load<N>(r[5] + u),
                                   load<N>(r[6] + u));
            store<N>(to[k] + u, sums[k]);
          }
          strong[(u - 1 + N - 1) / N] = Ops::bits(sums[0] + sums[2] >= min_trace) != 0;
        });
  }

  static void harris(const std::uint8_t* image, std::ptrdiff_t stride, int n, float min_eigenvalue,
                     float* response, float* scratch) {
    HarrisRows kept(scratch, n);
    __builtin_memset(response, 0, static_cast<std::size_t>(n) * static_cast<std::size_t>(n) * 4);
    // A little less, as floats are rounded.
    const float min_trace = 2.0F * min_eigenvalue * (1.0F - 1e-5F);
    bool strong[kMaxHarrisSize / N + 2];
    for (int v = 1; v < n - 1; ++v) {
      gradient_row(image + v * stride, stride, n, kept.products(v));
      // The row whose seven are there now.
      const int middle = v - 3;
      if (middle < kHarrisEdge) continue;
      smooth_columns(kept, middle, n, min_trace, strong);
      float* const(&smooth)[3] = kept.smooth();
      float* out = response + static_cast<std::ptrdiff_t>(middle) * n;
      cover(
          kHarrisEdge, n - kHarrisEdge, [&](int u) __attribute__((always_inline)) {
            // Columns u - 3 to u + N + 2. The last block does not begin with one of strong's.
            const int block = (u - kHarrisEdge) / N;
            bool any = (u - kHarrisEdge) % N != 0;
            for (int k = 0; k <= (N + 5) / N; ++k) any |= strong[block + k];
            if (!any) return;
            store<N>(out + u,
                     corner_response(window_along(smooth[0] + u), window_along(smooth[1] + u),
                                     window_along(smooth[2] + u), min_eigenvalue));
          });
    }
  }
  static ZENITH_INLINE F corner_response(const F& a, const F& b, const F& c, float min) {
    const F r = a * c - b * b - 0.04F * (a + c) * (a + c);
    const I strong = ((a - min) * (c - min) - b * b >= 0.0F) & (a + c >= 2.0F * min) & (r > 0.0F);
    return strong ? r : F{};
  }

  static int peaks(const float* response, int n, int border, std::int32_t* places, int room) {
    int count = 0;
    for (int v = border; v < n - border && count + n <= room; ++v) {
      const float* r = response + static_cast<std::ptrdiff_t>(v) * n;
      int u = border;
      for (; u + N <= n - border; u += N) {
        const F m = load<N>(r + u);
        const I positive = m > 0.0F;
        if (Ops::bits(positive) == 0) continue;
        const I before = (m >= load<N>(r + u - 1)) & (m >= load<N>(r + u - n - 1)) &
                         (m >= load<N>(r + u - n)) & (m >= load<N>(r + u - n + 1));
        const I after = (m > load<N>(r + u + 1)) & (m > load<N>(r + u + n - 1)) &
                        (m > load<N>(r + u + n)) & (m > load<N>(r + u + n + 1));
        for (unsigned hits = Ops::bits(positive & before & after); hits != 0; hits &= hits - 1) {
          places[count++] = v * n + u + __builtin_ctz(hits);
        }
      }
      for (; u < n - border; ++u) {
        const float m = r[u];
        const bool before =
            m >= r[u - 1] && m >= r[u - n - 1] && m >= r[u - n] && m >= r[u - n + 1];
        const bool after = m > r[u + 1] && m > r[u + n - 1] && m > r[u + n] && m > r[u + n + 1];
        if (m > 0.0F && before && after) places[count++] = v * n + u;
      }
    }
    return count;
  }

  // --- patches ---

  static constexpr int kParts = 16 / N;  // vectors in a row of sixteen

  // Sixteen sums.
  struct Sums {
    F parts[kParts] = {};
    ZENITH_INLINE float total() const {
      float sum[16];
      __builtin_memcpy(sum, parts, sizeof(sum));
      for (int half = 8; half > 0; half /= 2) {
        for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
      }
      return sum[0];
    }
  };
  static ZENITH_INLINE F counting(float first) {
    F lanes;
    for (int i = 0; i < N; ++i) lanes[i] = first + static_cast<float>(i);
    return lanes;
  }
  static ZENITH_INLINE F greys(const std::uint8_t* from) {
    return __builtin_convertvector(__builtin_convertvector(load<N>(from), I), F);
  }

  static CentroidSums centroid(const std::uint8_t* image, std::ptrdiff_t stride, int cu, int cv,
                               float du, float dv) {
    constexpr float kScale = 1.0F / (kPatchDisc * kPatchDisc);
    Sums w, wx, wy, i, ix, iy;
    for (int y = -kPatchDisc; y <= kPatchDisc; ++y) {
      const std::uint8_t* row = image + (cv + y) * stride + cu - kPatchDisc;
      const float fy = static_cast<float>(y) - dv;
      const float fy2 = fy * fy;
      for (int part = 0; part < kParts; ++part) {
        const F fx = counting(static_cast<float>(part * N - kPatchDisc)) - du;
        const F weight = larger(1.0F - (fx * fx + fy2) * kScale, F{});
        const F grey = weight * greys(row + part * N);
        w.parts[part] += weight;
        wx.parts[part] += weight * fx;
        wy.parts[part] += weight * fy;
        i.parts[part] += grey;
        ix.parts[part] += grey * fx;
        iy.parts[part] += grey * fy;
      }
      // The seventeenth column.
      const float fx = static_cast<float>(kPatchDisc) - du;
      const float inside = 1.0F - (fx * fx + fy2) * kScale;
      const float weight = inside < 0.0F ? 0.0F : inside;
      const float grey = weight * static_cast<float>(row[16]);
      w.parts[0][0] += weight;
      wx.parts[0][0] += weight * fx;
      wy.parts[0][0] += weight * fy;
      i.parts[0][0] += grey;
      ix.parts[0][0] += grey * fx;
      iy.parts[0][0] += grey * fy;
    }
    return {w.total(), wx.total(), wy.total(), i.total(), ix.total(), iy.total()};
  }

  static ZENITH_INLINE F without_sign(const F& x) {
    return reinterpret_cast<F>(reinterpret_cast<I>(x) & 0x7fffffff);
  }

  static ZENITH_INLINE float quantise(const float* values, int count, std::int8_t* out) {
    F most = {};
    for (int i = 0; i < count; i += N) most = larger(most, without_sign(load<N>(values + i)));
    float largest = 0.0F;
    for (int i = 0; i < N; ++i) largest = largest < most[i] ? most[i] : largest;
    if (largest <= 0.0F) {
      __builtin_memset(out, 0, static_cast<std::size_t>(count));
      return 0.0F;
    }
    const float scale = 127.0F / largest;
    I squares = {};
    for (int i = 0; i < count; i += N) {
      const F x = load<N>(values + i) * scale;
      // To the nearest, halves away from zero: what just misses a half must not be rounded up to
      // it.
      const I sign = reinterpret_cast<I>(x) & static_cast<std::int32_t>(0x80000000U);
      const I half = reinterpret_cast<I>(F{} + 0.49999997F) | sign;
      const I q = __builtin_convertvector(x + reinterpret_cast<F>(half), I);
      squares += q * q;
      using Narrow [[gnu::vector_size(N)]] = std::int8_t;
      const Narrow narrow = __builtin_convertvector(q, Narrow);
      __builtin_memcpy(out + i, &narrow, N);
    }
    std::int32_t sum = 0;
    for (int i = 0; i < N; ++i) sum += squares[i];
    return 1.0F / __builtin_sqrtf(static_cast<float>(sum));
  }

  static float patch(const std::uint8_t* image, std::ptrdiff_t stride, float u0, float v0, float c,
                     float s, float min_contrast, std::int8_t* out) {
    constexpr float kHalf = 0.5F * (kPatchSide - 1);
    constexpr int kCount = kPatchSide * kPatchSide;
    alignas(64) float values[kCount];
    Sums sums;
    const auto row_step = static_cast<std::int32_t>(stride);
    for (int y = 0; y < kPatchSide; ++y) {
      const float py = static_cast<float>(y) - kHalf;
      for (int part = 0; part < kParts; ++part) {
        const F px = counting(static_cast<float>(part * N) - kHalf);
        const F u = u0 + c * px - s * py;
        const F v = v0 + s * px + c * py;
        const I iu = __builtin_convertvector(u, I);
        const I iv = __builtin_convertvector(v, I);
        const F wu = u - __builtin_convertvector(iu, F);
        const F wv = v - __builtin_convertvector(iv, F);
        const I at = iv * row_step + iu;
        const I a = Ops::gather(image, at);
        const I b = Ops::gather(image + stride, at);
        const F top = between(a, wu);
        const F value = top + wv * (between(b, wu) - top);
        store<N>(values + y * kPatchSide + part * N, value);
        sums.parts[part] += value;
      }
    }
    const float mean = sums.total() * (1.0F / kCount);
    Sums energy;
    for (int i = 0; i < kCount; i += N) {
      const F value = load<N>(values + i) - mean;
      store<N>(values + i, value);
      energy.parts[i / N % kParts] += value * value;
    }
    if (energy.total() < min_contrast * min_contrast * kCount) {
      __builtin_memset(out, 0, kCount);
      return 0.0F;
    }
    return quantise(values, kCount, out);
  }
  static ZENITH_INLINE F between(const I& bytes, const F& weight) {
    const I left = bytes & 255;
    const I right = (bytes >> 8) & 255;
    return __builtin_convertvector(left, F) + weight * __builtin_convertvector(right - left, F);
  }

  // Over kDctKept frequencies at once; wider vectors would have nothing more to do.
  static float compact(const DctTable& dct, const std::int8_t* patch, std::int8_t* out) {
    constexpr int M = N < kDctKept ? N : kDctKept;
    constexpr int kVectors = kDctKept / M;
    using G = Floats<M>;
    G rows[kPatchSide][kVectors];
    for (int y = 0; y < kPatchSide; ++y) {
      G sums[kVectors] = {};
      for (int x = 0; x < kPatchSide; ++x) {
        const auto value = static_cast<float>(patch[y * kPatchSide + x]);
        for (int k = 0; k < kVectors; ++k) sums[k] += load<M>(dct.by_place[x] + k * M) * value;
      }
      for (int k = 0; k < kVectors; ++k) rows[y][k] = sums[k];
    }
    float all[kDctKept][kDctKept];  // [frequency of v][frequency of u]
    for (int f = 0; f < kDctKept; ++f) {
      G sums[kVectors] = {};
      for (int y = 0; y < kPatchSide; ++y) {
        for (int k = 0; k < kVectors; ++k) sums[k] += dct.by_frequency[f][y] * rows[y][k];
      }
      for (int k = 0; k < kVectors; ++k) store<M>(all[f] + k * M, sums[k]);
    }
    alignas(64) float coefficients[kCompactValues];
    for (int i = 0; i < kCompactValues; ++i) {
      coefficients[i] = all[dct.order[i][1]][dct.order[i][0]];
    }
    return quantise(coefficients, kCompactValues, out);
  }

  static constexpr ImageTable table(Isa isa) {
    return {isa, remap, harris, peaks, centroid, patch, compact};
  }
};

// For instruction sets that cannot gather.
struct LoadsOneByOne {
  static ZENITH_INLINE Shorts<4> shorts(const std::uint8_t* from) {
    return __builtin_convertvector(load<4>(from), Shorts<4>);
  }
  static ZENITH_INLINE Ints<4> ints(const Shorts<4>& s) {
    return __builtin_convertvector(s, Ints<4>);
  }
  static ZENITH_INLINE Ints<4> gather(const std::uint8_t* base, const Ints<4>& offsets) {
    Ints<4> out;
    for (int i = 0; i < 4; ++i) {
      std::int32_t bytes;
      __builtin_memcpy(&bytes, base + offsets[i], 4);
      out[i] = bytes;
    }
    return out;
  }
  static ZENITH_INLINE void deinterleave(const RemapEntry* entries, Ints<4>& uv, Ints<4>& weights) {
    Ints<4> low;
    Ints<4> high;
    __builtin_memcpy(&low, entries, sizeof(low));
    __builtin_memcpy(&high, entries + 2, sizeof(high));
    uv = __builtin_shufflevector(low, high, 0, 2, 4, 6);
    weights = __builtin_shufflevector(low, high, 1, 3, 5, 7);
  }
};

}  // namespace
}  // namespace zenith
