#include "slam/filter/motion.h"

#include <algorithm>

namespace zenith {

bool WheelHistory::add(const WheelSample& sample) {
  if (size_ > 0 && sample.stamp <= nth(size_ - 1).stamp) return false;
  if (!std::isfinite(sample.left_m) || !std::isfinite(sample.right_m)) return false;
  if (size_ == kMaxWheelSamples) {
    head_ = (head_ + 1) % kMaxWheelSamples;
    --size_;
  }
  samples_[(head_ + size_) % kMaxWheelSamples] = sample;
  ++size_;
  return true;
}

WheelHistory::At WheelHistory::at(Time stamp) const {
  if (size_ == 0) return {};
  const WheelSample& newest = nth(size_ - 1);
  if (size_ == 1 || stamp <= nth(0).stamp) {
    const WheelSample& only = nth(0);
    return {{only.left_m, only.right_m}, stamp != only.stamp, true};
  }
  // The pair around the stamp, or the last pair when the stamp lies beyond it.
  int i = size_ - 1;
  while (i > 1 && nth(i - 1).stamp >= stamp) --i;
  const WheelSample& a = nth(i - 1);
  const WheelSample& b = nth(i);
  const bool beyond = stamp > newest.stamp;
  constexpr Duration kHold = {100'000'000};
  const Time t = beyond ? std::min(stamp, newest.stamp + kHold) : stamp;
  const double s =
      static_cast<double>((t - a.stamp).ns) / static_cast<double>((b.stamp - a.stamp).ns);
  return {{a.left_m + s * (b.left_m - a.left_m), a.right_m + s * (b.right_m - a.right_m)},
          beyond,
          true};
}

}  // namespace zenith
