#pragma once
// Normalised cross correlation of patches (paper III-A): the dot product of the two patches made
// zero-mean and unit-norm, in [-1, 1]. A patch without contrast is similar to nothing (0).

#include <cstdint>

#include "slam/image/patch.h"

namespace zenith {

// The kernels: exact integer dot products.
inline int dot_i8(const std::int8_t* a, const std::int8_t* b, int n) {
  int sum = 0;
  for (int i = 0; i < n; ++i) sum += static_cast<int>(a[i]) * static_cast<int>(b[i]);
  return sum;
}

inline float ncc(const Patch& a, const Patch& b) {
  return static_cast<float>(dot_i8(a.values.data(), b.values.data(), kPatchLength)) *
         a.inverse_norm * b.inverse_norm;
}

inline float ncc(const CompactPatch& a, const CompactPatch& b) {
  return static_cast<float>(dot_i8(a.values.data(), b.values.data(), kCompactLength)) *
         a.inverse_norm * b.inverse_norm;
}

}  // namespace zenith
