// Pairs of values, widened to 16 bits, multiplied and added by pmaddwd.
#ifdef ZENITH_WITH_SSE41
#include <immintrin.h>

#include "slam/kernels/match/match_pairs.h"
#include "slam/kernels/match/match_pruned_body.h"

namespace zenith {
namespace {

struct Sse41 : Pairs {
  static constexpr int kLanes = 4;
  static constexpr int kVectors = 2;
  using Vector = __m128i;
  using Sums = __m128i;

  static ZENITH_INLINE Vector load_queries(const std::int8_t* q) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(q));
  }
  static ZENITH_INLINE Vector broadcast(const std::int8_t* word) {
    return _mm_set1_epi32(word_at(word));
  }
  static ZENITH_INLINE Sums begin(const std::int32_t*) { return _mm_setzero_si128(); }
  static ZENITH_INLINE Sums add(Sums sums, Vector q, Vector word) {
    return _mm_add_epi32(sums, _mm_madd_epi16(q, word));
  }
  static ZENITH_INLINE Ints<4> lanes(Sums sums) { return reinterpret_cast<Ints<4>>(sums); }
  static ZENITH_INLINE unsigned above(const Floats<4>& a, const Floats<4>& b) {
    return static_cast<unsigned>(
        _mm_movemask_ps(_mm_cmpgt_ps(reinterpret_cast<__m128>(a), reinterpret_cast<__m128>(b))));
  }

  template <int kLength>
  static ZENITH_INLINE std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    __m128i sums = _mm_setzero_si128();
    for (int i = 0; i < kLength; i += 8) {
      const __m128i wide_a = _mm_cvtepi8_epi16(_mm_loadu_si64(a + i));
      const __m128i wide_b = _mm_cvtepi8_epi16(_mm_loadu_si64(b + i));
      sums = _mm_add_epi32(sums, _mm_madd_epi16(wide_a, wide_b));
    }
    const auto s = reinterpret_cast<Ints<4>>(sums);
    return s[0] + s[1] + s[2] + s[3];
  }
};

}  // namespace

const MatchTable kMatchSse41 = match_table_of<Sse41>(Isa::kSse41);

}  // namespace zenith
#endif
