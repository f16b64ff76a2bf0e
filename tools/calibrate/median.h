#pragma once
// The middle one of some values, of which there is one at least.

#include <algorithm>
#include <cassert>
#include <vector>

namespace zenith::tools {

inline double median(std::vector<double> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Standard deviation of normal errors from their absolute sizes; outliers do not matter.
inline double robust_sigma(std::vector<double> sizes) {
  return 1.4826 * median(std::move(sizes));
}

}  // namespace zenith::tools
