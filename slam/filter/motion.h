#pragma once
// The motion of a differential drive from its wheels' travel.
//
//   d = (right + left) / 2,   dtheta = (right - left) / track_width
//   the robot moves on an arc: chord d sinc(dtheta / 2), direction dtheta / 2
//
// Source: Thrun, Burgard, Fox, "Probabilistic Robotics", 5.4, in the exact-arc form.

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "platform/base/time.h"
#include "slam/bounds.h"
#include "slam/capacity.h"
#include "slam/geometry.h"
#include "slam/robot.h"
#include "slam/wheels.h"

namespace zenith {

struct WheelTravel {
  double left_m = 0.0;
  double right_m = 0.0;
};

// The pose reached from the origin of base_link by this travel.
inline Pose2 wheel_motion(const Wheels& wheels, const WheelTravel& travel) {
  const double left = travel.left_m * wheels.left_scale;
  const double right = travel.right_m * wheels.right_scale;
  const double d = 0.5 * (left + right);
  const double dtheta = (right - left) / wheels.track_width_m;
  const double half = 0.5 * dtheta;
  const double chord = std::abs(half) < 1e-9 ? d : d * std::sin(half) / half;
  return {chord * std::cos(half), chord * std::sin(half), dtheta};
}

// Keeps the newest wheel samples and tells the total travel at any stamp among them. Full: the
// oldest is overwritten. Beyond the newest sample the last speed is held for at most 100 ms.
class WheelHistory {
 public:
  // False when the sample is refused: beyond the bounds (slam/bounds.h), or not newer than the
  // last. Samples of a clock that was set back are taken again after kOtherClockSamples. A total
  // that jumps further than a wheel turns counts as no travel, and the next ones go on from it.
  bool add(const WheelSample& sample);
  std::uint64_t jumps() const { return jumps_; }

  struct At {
    WheelTravel total;
    bool extrapolated = false;
    bool known = false;  // false before the first sample
  };
  At at(Time stamp) const;

 private:
  const WheelSample& nth(int i) const { return samples_[(head_ + i) % kMaxWheelSamples]; }

  std::array<WheelSample, kMaxWheelSamples> samples_ = {};
  int head_ = 0;
  int size_ = 0;
  WheelTravel told_;   // by the last sample
  WheelTravel shift_;  // from what samples tell to the total without jumps
  StampGuard stamps_{kOtherClockSamples};
  std::uint64_t jumps_ = 0;
};

}  // namespace zenith
