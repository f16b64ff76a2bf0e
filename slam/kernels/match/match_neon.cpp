// For 64-bit and 32-bit ARM: products of bytes widened to 16 bits, added in pairs.
#ifdef ZENITH_WITH_NEON
#include "slam/kernels/match/match_pruned_body.h"
#include "slam/kernels/match/match_quads_neon.h"

namespace zenith {
namespace {

struct Neon : QuadsNeon {
  static constexpr int kVectors = 2;
  // Two sums for each query: of queries 0 and 1, and of 2 and 3.
  struct Sums {
    int32x4_t low;
    int32x4_t high;
  };

  static ZENITH_INLINE Sums begin(const std::int32_t*) { return {vdupq_n_s32(0), vdupq_n_s32(0)}; }
  static ZENITH_INLINE Sums add(const Sums& sums, Vector q, Vector word) {
    const int8x8_t half = vget_low_s8(word);
    return {vpadalq_s16(sums.low, vmull_s8(vget_low_s8(q), half)),
            vpadalq_s16(sums.high, vmull_s8(vget_high_s8(q), half))};
  }
  static ZENITH_INLINE int32x2_t both(int32x4_t sums) {
    return vpadd_s32(vget_low_s32(sums), vget_high_s32(sums));
  }
  static ZENITH_INLINE Ints<4> lanes(const Sums& sums) {
    return ints(vcombine_s32(both(sums.low), both(sums.high)));
  }

  template <int kLength>
  static ZENITH_INLINE std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    int32x4_t sums = vdupq_n_s32(0);
    for (int i = 0; i < kLength; i += 8) {
      sums = vpadalq_s16(sums, vmull_s8(vld1_s8(a + i), vld1_s8(b + i)));
    }
    const int32x2_t pair = both(sums);
    return vget_lane_s32(pair, 0) + vget_lane_s32(pair, 1);
  }
};

}  // namespace

const MatchTable kMatchNeon = match_table_of<Neon>(Isa::kNeon);

}  // namespace zenith
#endif
