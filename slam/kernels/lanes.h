#pragma once
// N numbers that are calculated with at once. A kernel is written once over Lanes<N> and compiled
// for each instruction set with its own N, with the compiler's vector types underneath.
//
// For the files of slam/kernels that are compiled with flags of an instruction set. Everything here
// is in an unnamed namespace and always inlined, so that no code of such a file is ever linked into
// another one: std:: algorithms, which are shared between files, must not be called there either.

#include <cstdint>

namespace zenith {
namespace {

#define ZENITH_INLINE inline __attribute__((always_inline))

template <int N>
struct LaneTypes {
  using Float [[gnu::vector_size(N * 4)]] = float;
  using Int [[gnu::vector_size(N * 4)]] = std::int32_t;
  using Double [[gnu::vector_size(N * 8)]] = double;
  using Byte [[gnu::vector_size(N)]] = std::uint8_t;
  using Short [[gnu::vector_size(N * 2)]] = std::int16_t;
};

template <int N>
using Floats = typename LaneTypes<N>::Float;
template <int N>
using Ints = typename LaneTypes<N>::Int;
template <int N>
using Doubles = typename LaneTypes<N>::Double;
template <int N>
using Bytes = typename LaneTypes<N>::Byte;
template <int N>
using Shorts = typename LaneTypes<N>::Short;

// From and to memory that need not be aligned.
template <int N>
ZENITH_INLINE Floats<N> load(const float* from) {
  Floats<N> lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

template <int N>
ZENITH_INLINE Bytes<N> load(const std::uint8_t* from) {
  Bytes<N> lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

template <int N>
ZENITH_INLINE void store(float* to, const Floats<N>& lanes) {
  __builtin_memcpy(to, &lanes, sizeof(lanes));
}

template <int N>
ZENITH_INLINE Doubles<N> load(const double* from) {
  Doubles<N> lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

// A bit for each lane that is not 0, for instruction sets without one for it; seldom there is any.
ZENITH_INLINE unsigned bits_of(const Ints<4>& mask) {
  unsigned long long halves[2];
  __builtin_memcpy(halves, &mask, sizeof(halves));
  if ((halves[0] | halves[1]) == 0) return 0;
  return (mask[0] != 0 ? 1U : 0U) | (mask[1] != 0 ? 2U : 0U) | (mask[2] != 0 ? 4U : 0U) |
         (mask[3] != 0 ? 8U : 0U);
}

// As std::min(a, b): b where b < a, else a.
template <typename V>
ZENITH_INLINE V smaller(const V& a, const V& b) {
  return b < a ? b : a;
}

// As std::max(a, b): b where a < b, else a.
template <typename V>
ZENITH_INLINE V larger(const V& a, const V& b) {
  return a < b ? b : a;
}

}  // namespace
}  // namespace zenith
