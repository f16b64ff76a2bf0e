#pragma once
// The motion that was seen against the wheels' over a whole recording: slam/watch's wheel_fit.h for
// any range of delays between both clocks, not only the 0.4 s that a robot on the way looks at.

#include <span>

#include "slam/robot.h"
#include "slam/watch/wheel_fit.h"
#include "tools/calibrate/seen_motion.h"
#include "tools/calibrate/wheel_curve.h"

namespace zenith::tools {

struct DelayRange {
  double from_s = 0.0;
  double to_s = 0.0;
};

struct SetupFit {
  bool known = false;  // enough turning was seen while the wheels told of their travel
  WheelFit fit;        // at the best delay
  double delay_s = 0.0;
  double delay_sigma_s = 0.0;
  // Rest of the turns without a delay by the rest with it; infinite where the wheels tell nothing
  // without a delay.
  double gain = 1.0;
  double forward_m = 0.0;  // by the wheels, with its sign
  int intervals = 0;

  // The delay is one, and not chance.
  bool delay_is_sure() const;
};

// Positive delays: the wheels' stamps are late. Delays at which the wheels tell nothing of most of
// what was seen are left out.
SetupFit fit_setup(std::span<const SeenInterval> seen, const WheelCurve& wheels,
                   const Wheels& believed, DelayRange range);

}  // namespace zenith::tools
