#ifdef __x86_64__
#include <immintrin.h>

#include "tests/bench/limits.h"

namespace zenith::bench {
namespace {

constexpr int kSums = 16;

void bytes(int rounds) {
  __m512i sums[kSums] = {};
  const __m512i a = _mm512_set1_epi8(3);
  const __m512i b = _mm512_set1_epi8(5);
  for (int r = 0; r < rounds; ++r) {
    for (__m512i& s : sums) {
      s = _mm512_dpbusd_epi32(s, a, b);
      asm volatile("" : "+v"(s));
    }
  }
}

void floats(int rounds) {
  __m512 sums[kSums] = {};
  const __m512 a = _mm512_set1_ps(0.5F);
  const __m512 b = _mm512_set1_ps(0.25F);
  for (int r = 0; r < rounds; ++r) {
    for (__m512& s : sums) {
      s = _mm512_fmadd_ps(a, b, s);
      asm volatile("" : "+v"(s));
    }
  }
}

}  // namespace

extern const Limit kLimitBytesAvx512 = {"byte dot products, avx512 vnni", 64 * kSums, bytes};
extern const Limit kLimitFloatsAvx512 = {"float multiply-add, avx512", 16 * kSums, floats};

}  // namespace zenith::bench
#endif
