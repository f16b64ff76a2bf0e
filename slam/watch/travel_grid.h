#pragma once
// The wheels' total travel at even stamps, for two seconds: travel between any two moments in
// constant time, also moments that the frames' stamps are shifted by.

#include <array>
#include <cmath>
#include <cstdint>

#include "slam/filter/motion.h"

namespace zenith {

class TravelGrid {
 public:
  static constexpr Duration kStep = {20'000'000};
  static constexpr int kSize = 128;
  static constexpr Duration kBack = {1'000'000'000};  // before the first frame

  // After new samples came; `now` is the frame's stamp. What the history does not hold is left out.
  void advance(const WheelHistory& wheels, Time now) {
    if (count_ == 0 || now - next_ > Duration{kStep.ns * kSize} || next_ - now > kOtherClock) {
      count_ = 0;
      next_ = now - kBack;
    }
    for (int i = 0; i < kSize; ++i) {
      const WheelHistory::At at = wheels.at(next_);
      if (!at.known || at.extrapolated) {
        if (count_ > 0 || next_ >= now) return;
        next_ = next_ + kStep;  // before the first sample
        continue;
      }
      travel_[static_cast<std::size_t>((first_ + count_) % kSize)] = at.total;
      if (count_ < kSize) {
        ++count_;
      } else {
        first_ = (first_ + 1) % kSize;
      }
      next_ = next_ + kStep;
    }
  }

  bool covers(Time from, Time to) const {
    return count_ >= 2 && from >= begin() && to <= next_ - kStep;
  }

  // Covered ones alone.
  WheelTravel between(Time from, Time to) const {
    const WheelTravel a = at(from);
    const WheelTravel b = at(to);
    return {b.left_m - a.left_m, b.right_m - a.right_m};
  }

 private:
  Time begin() const { return next_ - Duration{kStep.ns * count_}; }

  WheelTravel at(Time stamp) const {
    const double steps = static_cast<double>((stamp - begin()).ns) / static_cast<double>(kStep.ns);
    const int i = std::clamp(static_cast<int>(steps), 0, count_ - 2);
    const double s = steps - i;
    const WheelTravel& a = travel_[static_cast<std::size_t>((first_ + i) % kSize)];
    const WheelTravel& b = travel_[static_cast<std::size_t>((first_ + i + 1) % kSize)];
    return {a.left_m + s * (b.left_m - a.left_m), a.right_m + s * (b.right_m - a.right_m)};
  }

  std::array<WheelTravel, kSize> travel_ = {};
  int first_ = 0;
  int count_ = 0;
  Time next_;
};

}  // namespace zenith
