#pragma once
// What the watch measured of the set-up: figures beside the verdict, with the value of a right one.

#include <Eigen/Core>

#include "slam/watch/lens_fit.h"

namespace zenith {

// What was measured of the set-up, for reports. Meaningful when `judged`.
struct SetupMeasures {
  bool judged = false;      // moved and turned enough
  int intervals = 0;        // compared so far
  double turn_scale = 0.0;  // turn seen by turn of the wheels: 1
  // An error of the wheels' metre beyond this would have been found by the turns; 1: none would.
  double metre_checked_to = 1.0;
  double wheel_balance = 0.0;  // turn seen per distance driven straight, times half the track: 0
  double yaw_error_rad = 0.0;  // direction of straight driving as seen: 0
  double height_m = 0.0;       // of what is seen above the camera, on average
  double delay_s = 0.0;        // of the wheels' stamps against the frames'
  double jitter_s = 0.0;       // of the stamps: 0
  LensError lens;              // 0
  double standing = 0.0;       // share of the corners that stand while the others move: 0
  double unexplained = 0.0;    // share of the seen turns' power
  Eigen::Vector2d vertical = Eigen::Vector2d::Zero();  // where it lies, tangents: (0, 0)
};

}  // namespace zenith
