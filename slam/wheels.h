#pragma once
// What odometry delivers to the core: the total travel of each wheel since an arbitrary start.

#include "platform/base/time.h"

namespace zenith {

// Unwrapped and in metres: counters' overflow and restart are the codec's business.
struct WheelSample {
  Time stamp;
  double left_m = 0.0;
  double right_m = 0.0;
};

}  // namespace zenith
