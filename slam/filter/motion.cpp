#include "slam/filter/motion.h"

#include <algorithm>

namespace zenith {

bool WheelHistory::add(const WheelSample& sample) {
  if (!is_within(sample.left_m, kMostTravel_m) || !is_within(sample.right_m, kMostTravel_m)) {
    return false;
  }
  const StampGuard::Verdict verdict = stamps_.take(sample.stamp);
  if (verdict == StampGuard::Verdict::kRefused) return false;
  if (size_ > 0) {
    const WheelSample& last = nth(size_ - 1);
    const bool new_time = verdict == StampGuard::Verdict::kNewTime;
    const Duration longest = {10'000'000'000};
    const double interval_s =
        new_time ? 0.0 : std::min(sample.stamp - last.stamp, longest).seconds();
    const double most_m = kWheelSlack_m + kFastest_m_per_s * interval_s;
    if (!is_within(sample.left_m - told_.left_m, most_m) ||
        !is_within(sample.right_m - told_.right_m, most_m)) {
      shift_ = {last.left_m - sample.left_m, last.right_m - sample.right_m};
      ++jumps_;
    }
    if (new_time) size_ = 0;
  }
  told_ = {sample.left_m, sample.right_m};
  if (size_ == kMaxWheelSamples) {
    head_ = (head_ + 1) % kMaxWheelSamples;
    --size_;
  }
  samples_[(head_ + size_) % kMaxWheelSamples] = {sample.stamp, sample.left_m + shift_.left_m,
                                                  sample.right_m + shift_.right_m};
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
  const WheelTravel there = {a.left_m + s * (b.left_m - a.left_m),
                             a.right_m + s * (b.right_m - a.right_m)};
  // Two samples right after each other tell no speed.
  const double most_m = kWheelSlack_m + kFastest_m_per_s * kHold.seconds();
  if (beyond && (!is_within(there.left_m - b.left_m, most_m) ||
                 !is_within(there.right_m - b.right_m, most_m))) {
    return {{b.left_m, b.right_m}, true, true};
  }
  return {there, beyond, true};
}

}  // namespace zenith
