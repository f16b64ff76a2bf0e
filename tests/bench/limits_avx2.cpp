#ifdef __x86_64__
#include <immintrin.h>

#include "tests/bench/limits.h"

namespace zenith::bench {
namespace {

// Ten accumulators: as many as leave room for the factors.
constexpr int kSums = 10;

// One factor from the first cache, as the kernel has it. Written out: compilers keep sums in
// memory.
void pairs(int rounds) {
  alignas(32) static __m256i factors[kSums] = {};
  __m256i sums[kSums] = {};
  const __m256i a = _mm256_set1_epi16(3);
  for (int r = 0; r < rounds; ++r) {
#pragma GCC unroll 10
    for (int i = 0; i < kSums; ++i) {
      __m256i product;
      asm volatile("vpmaddwd %2, %3, %1\n\tvpaddd %1, %0, %0"
                   : "+x"(sums[i]), "=&x"(product)
                   : "m"(factors[i]), "x"(a));
    }
  }
}

void floats(int rounds) {
  __m256 sums[kSums] = {};
  const __m256 a = _mm256_set1_ps(0.5F);
  const __m256 b = _mm256_set1_ps(0.25F);
  for (int r = 0; r < rounds; ++r) {
    for (__m256& s : sums) {
      s = _mm256_fmadd_ps(a, b, s);
      asm volatile("" : "+x"(s));
    }
  }
}

}  // namespace

extern const Limit kLimitPairsAvx2 = {"16-bit pairs and additions, avx2", 16 * kSums, pairs};
extern const Limit kLimitFloatsAvx2 = {"float multiply-add, avx2", 8 * kSums, floats};

}  // namespace zenith::bench
#endif
