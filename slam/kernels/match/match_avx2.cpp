// Pairs of values, widened to 16 bits, multiplied and added by vpmaddwd. (Products of bytes,
// vpmaddubsw, would need a sign to be moved from one factor to the other: no fewer instructions.)
#ifdef ZENITH_WITH_AVX2
#include <immintrin.h>

#include "slam/kernels/match/match_dot_avx2.h"
#include "slam/kernels/match/match_pairs.h"
#include "slam/kernels/match/match_pruned_body.h"

namespace zenith {
namespace {

struct Avx2 : Pairs {
  static constexpr int kLanes = 8;
  static constexpr int kVectors = 2;
  using Vector = __m256i;
  using Sums = __m256i;

  static ZENITH_INLINE Vector load_queries(const std::int8_t* q) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(q));
  }
  static ZENITH_INLINE Vector broadcast(const std::int8_t* word) {
    return _mm256_set1_epi32(word_at(word));
  }
  static ZENITH_INLINE Sums begin(const std::int32_t*) { return _mm256_setzero_si256(); }
  static ZENITH_INLINE Sums add(Sums sums, Vector q, Vector word) {
    return _mm256_add_epi32(sums, _mm256_madd_epi16(q, word));
  }
  static ZENITH_INLINE Ints<8> lanes(Sums sums) { return reinterpret_cast<Ints<8>>(sums); }
  static ZENITH_INLINE unsigned above(const Floats<8>& a, const Floats<8>& b) {
    return static_cast<unsigned>(_mm256_movemask_ps(
        _mm256_cmp_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b), _CMP_GT_OQ)));
  }

  template <int kLength>
  static ZENITH_INLINE std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    return dot_256<kLength>(a, b);
  }
};

}  // namespace

const MatchTable kMatchAvx2 = match_table_of<Avx2>(Isa::kAvx2);

}  // namespace zenith
#endif
