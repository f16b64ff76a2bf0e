#pragma once
// How many corners a frame may have, so that its step ends within the frame's period.
//
//   a step above busy_share of the period       limit <- 3/4 limit, not below corners_min
//   kCalm steps in a row below half of that     limit <- limit + 1/8, not above corners_max
//
// Down at once and up slowly: a step grows about in proportion with its corners. Plain data.

#include <algorithm>
#include <cstdint>

#include "platform/base/time.h"
#include "slam/capacity.h"

namespace zenith {

struct LoadLimits {
  double busy_share = 0.8;
  int corners_min = 40;
  int corners_max = kMaxCorners;
};

class LoadShedder {
 public:
  static constexpr int kCalm = 20;

  void set(const LoadLimits& limits) {
    limits_ = limits;
    limits_.corners_min = std::min(limits_.corners_min, limits_.corners_max);
    limit_ = std::clamp(limit_, limits_.corners_min, limits_.corners_max);
    if (!sheds_) limit_ = limits_.corners_max;
  }

  // After each step.
  void note(Duration step, Duration period) {
    const double share = static_cast<double>(step.ns) / static_cast<double>(period.ns);
    if (share > limits_.busy_share) {
      calm_ = 0;
      limit_ = std::max(limits_.corners_min, limit_ * 3 / 4);
    } else if (share > 0.5 * limits_.busy_share) {
      calm_ = 0;
    } else if (++calm_ >= kCalm) {
      calm_ = 0;
      limit_ = std::min(limits_.corners_max, limit_ + std::max(1, limit_ / 8));
    }
    sheds_ = limit_ < limits_.corners_max;
    if (sheds_) ++frames_shed_;
  }

  int corners_max() const { return limit_; }
  bool sheds() const { return sheds_; }
  std::uint64_t frames_shed() const { return frames_shed_; }  // with fewer corners than configured

 private:
  LoadLimits limits_;
  int limit_ = kMaxCorners;
  int calm_ = 0;
  bool sheds_ = false;
  std::uint64_t frames_shed_ = 0;
};

}  // namespace zenith
