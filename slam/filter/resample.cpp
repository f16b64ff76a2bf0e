#include "slam/filter/resample.h"

#include <cassert>
#include <cstddef>

namespace zenith {

void systematic_resample(std::span<const double> weight, double uniform,
                         std::span<std::uint16_t> parents) {
  assert(weight.size() == parents.size() && !weight.empty());
  const std::size_t n = weight.size();
  const double step = 1.0 / static_cast<double>(n);
  double cumulated = weight[0];
  std::size_t from = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double pointer = (static_cast<double>(i) + uniform) * step;
    // Rounding may leave the sum a little below 1: the last particle takes what remains.
    while (pointer >= cumulated && from + 1 < n) cumulated += weight[++from];
    parents[i] = static_cast<std::uint16_t>(from);
  }
}

}  // namespace zenith
