#pragma once
// The sum of products of two patches in registers of 256 bits; wider ones gain nothing on one pair.
// For the kernels' own files: see lanes.h.

#include <immintrin.h>

#include "slam/kernels/lanes.h"

namespace zenith {
namespace {

template <int kLength>
ZENITH_INLINE std::int32_t dot_256(const std::int8_t* a, const std::int8_t* b) {
  __m256i sums = _mm256_setzero_si256();
  for (int i = 0; i < kLength; i += 16) {
    const __m256i wide_a =
        _mm256_cvtepi8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(a + i)));
    const __m256i wide_b =
        _mm256_cvtepi8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(b + i)));
    sums = _mm256_add_epi32(sums, _mm256_madd_epi16(wide_a, wide_b));
  }
  const __m128i half =
      _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
  const auto s = reinterpret_cast<Ints<4>>(half);
  return s[0] + s[1] + s[2] + s[3];
}

}  // namespace
}  // namespace zenith
