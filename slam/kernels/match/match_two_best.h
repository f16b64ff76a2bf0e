#pragma once
// How a query's two best looks change. For the kernels' own files: see lanes.h.

#include "slam/kernels/lanes.h"
#include "slam/kernels/match/match.h"

namespace zenith {
namespace {

// `look` of `landmark` has `ncc`, which is above found.second.ncc.
ZENITH_INLINE void take_if_better(int query, int look, std::int32_t landmark, float ncc,
                                  TwoBest& found) {
  if (ncc > found.best.ncc) {
    if (landmark != found.best_landmark) {
      found.second = found.best;
      found.second_landmark = found.best_landmark;
    }
    found.best = {query, look, ncc};
    found.best_landmark = landmark;
  } else if (landmark != found.best_landmark && ncc > found.second.ncc) {
    found.second = {query, look, ncc};
    found.second_landmark = landmark;
  }
}

}  // namespace
}  // namespace zenith
