#pragma once
// Normalised cross correlation of patches (paper III-A): the dot product of the two patches made
// zero-mean and unit-norm, in [-1, 1]. A patch without contrast is similar to nothing (0).

#include "slam/image/patch.h"
#include "slam/kernels/match/match.h"

namespace zenith {

inline float ncc(const Patch& a, const Patch& b) {
  return static_cast<float>(match_in_use().full.dot(a.values.data(), b.values.data())) *
         a.inverse_norm * b.inverse_norm;
}

inline float ncc(const CompactPatch& a, const CompactPatch& b) {
  return static_cast<float>(match_in_use().compact.dot(a.values.data(), b.values.data())) *
         a.inverse_norm * b.inverse_norm;
}

}  // namespace zenith
