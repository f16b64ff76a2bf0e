#pragma once
// Four values in a word, four queries in a vector: what both NEON versions share. For the kernels'
// own files: see lanes.h.

#include <arm_neon.h>

#include "slam/kernels/lanes.h"

namespace zenith {
namespace {

struct QuadsNeon {
  static constexpr int kLanes = 4;
  static constexpr int kStep = 4;
  static constexpr std::int32_t kLookOffset = 0;
  using Vector = int8x16_t;

  static ZENITH_INLINE std::int32_t query_word(const std::int8_t* values) {
    std::int32_t word;
    __builtin_memcpy(&word, values, 4);
    return word;
  }
  template <int kLength>
  static ZENITH_INLINE void prepare(const std::int8_t* values, std::int8_t* to) {
    __builtin_memcpy(to, values, kLength);
  }
  static ZENITH_INLINE Vector load_queries(const std::int8_t* q) { return vld1q_s8(q); }
  static ZENITH_INLINE Vector broadcast(const std::int8_t* word) {
    return vreinterpretq_s8_s32(vdupq_n_s32(query_word(word)));
  }
  static ZENITH_INLINE Ints<4> ints(int32x4_t lanes) {
    Ints<4> out;
    __builtin_memcpy(&out, &lanes, sizeof(out));
    return out;
  }
  static ZENITH_INLINE unsigned above(const Floats<4>& a, const Floats<4>& b) {
    return bits_of(a > b);
  }
};

}  // namespace
}  // namespace zenith
