#pragma once
// Two values in a word, widened to 16 bits. For the kernels' own files: see lanes.h.

#include "slam/kernels/lanes.h"

namespace zenith {
namespace {

struct Pairs {
  static constexpr int kStep = 2;
  static constexpr std::int32_t kLookOffset = 0;

  static ZENITH_INLINE std::int32_t query_word(const std::int8_t* values) {
    return static_cast<std::int32_t>(static_cast<std::uint16_t>(std::int16_t{values[0]}) |
                                     std::uint32_t{static_cast<std::uint16_t>(values[1])} << 16U);
  }
  static ZENITH_INLINE std::int32_t word_at(const std::int8_t* place) {
    std::int32_t word;
    __builtin_memcpy(&word, place, 4);
    return word;
  }
  template <int kLength>
  static ZENITH_INLINE void prepare(const std::int8_t* values, std::int8_t* to) {
    using Narrow [[gnu::vector_size(8)]] = std::int8_t;
    using Wide [[gnu::vector_size(16)]] = std::int16_t;
    for (int i = 0; i < kLength; i += 8) {
      Narrow narrow;
      __builtin_memcpy(&narrow, values + i, sizeof(narrow));
      const Wide wide = __builtin_convertvector(narrow, Wide);
      __builtin_memcpy(to + 2 * i, &wide, sizeof(wide));
    }
  }
};

}  // namespace
}  // namespace zenith
