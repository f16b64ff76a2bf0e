// Four products added at once: Cortex-A55, A76 and later.
#ifdef ZENITH_WITH_NEON_DOTPROD
#include "slam/kernels/match/match_pruned_body.h"
#include "slam/kernels/match/match_quads_neon.h"

namespace zenith {
namespace {

struct NeonDotprod : QuadsNeon {
  static constexpr int kVectors = 4;
  using Sums = int32x4_t;

  static ZENITH_INLINE Sums begin(const std::int32_t*) { return vdupq_n_s32(0); }
  static ZENITH_INLINE Sums add(Sums sums, Vector q, Vector word) {
    return vdotq_s32(sums, q, word);
  }
  static ZENITH_INLINE Ints<4> lanes(Sums sums) { return ints(sums); }

  template <int kLength>
  static ZENITH_INLINE std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    int32x4_t sums = vdupq_n_s32(0);
    for (int i = 0; i < kLength; i += 16) sums = vdotq_s32(sums, vld1q_s8(a + i), vld1q_s8(b + i));
    return vaddvq_s32(sums);
  }
};

}  // namespace

const MatchTable kMatchNeonDotprod = match_table_of<NeonDotprod>(Isa::kNeonDotprod);

}  // namespace zenith
#endif
