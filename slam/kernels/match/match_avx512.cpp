// Four values in a word: vpdpbusd multiplies unsigned bytes with signed ones. Looks are moved up by
// 128; the sums begin with -128 times the sum of the query's values, which takes it back exactly.
#ifdef ZENITH_WITH_AVX512
#include <immintrin.h>

#include "slam/kernels/match/match_dot_avx2.h"
#include "slam/kernels/match/match_pruned_body.h"

namespace zenith {
namespace {

struct Avx512 {
  static constexpr int kLanes = 16;
  static constexpr int kStep = 4;
  static constexpr int kVectors = 4;
  static constexpr std::int32_t kLookOffset = 128;
  using Vector = __m512i;
  using Sums = __m512i;

  static ZENITH_INLINE std::int32_t query_word(const std::int8_t* values) {
    std::int32_t word;
    __builtin_memcpy(&word, values, 4);
    return word;
  }
  template <int kLength>
  static ZENITH_INLINE void prepare(const std::int8_t* values, std::int8_t* to) {
    for (int i = 0; i < kLength; i += 32) {
      const __m256i signs = _mm256_set1_epi8(-128);
      const __m256i look = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + i));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + i), _mm256_xor_si256(look, signs));
    }
  }
  static ZENITH_INLINE Vector load_queries(const std::int8_t* q) { return _mm512_load_si512(q); }
  static ZENITH_INLINE Vector broadcast(const std::int8_t* word) {
    return _mm512_set1_epi32(query_word(word));
  }
  static ZENITH_INLINE Sums begin(const std::int32_t* start) { return _mm512_load_si512(start); }
  static ZENITH_INLINE Sums add(Sums sums, Vector q, Vector word) {
    return _mm512_dpbusd_epi32(sums, word, q);
  }
  static ZENITH_INLINE Ints<16> lanes(Sums sums) { return reinterpret_cast<Ints<16>>(sums); }
  static ZENITH_INLINE unsigned above(const Floats<16>& a, const Floats<16>& b) {
    return _mm512_cmp_ps_mask(reinterpret_cast<__m512>(a), reinterpret_cast<__m512>(b), _CMP_GT_OQ);
  }

  template <int kLength>
  static ZENITH_INLINE std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    return dot_256<kLength>(a, b);
  }
};

}  // namespace

const MatchTable kMatchAvx512 = match_table_of<Avx512>(Isa::kAvx512);

}  // namespace zenith
#endif
