#pragma once
// What the wheels report while the robot drives.
//
//   travel_i = integral of (v -+ w b / 2) dt                      true travel of wheel i
//   report_i = integral of (1 + e_i + drift_i(t)) d travel_i  +  slip noise  +  slip events
//
// e_i is constant for a run, drift_i an Ornstein-Uhlenbeck process, the slip noise has a variance
// proportional to the distance, a slip event adds 1 to 4 cm within 0.2 s. b is the true track
// width, which differs a little from the believed one. Reports are whole millimetres at 100 Hz.

#include <vector>

#include "drivers/odometry/can_frame.h"
#include "platform/base/random.h"
#include "sim/path.h"
#include "sim/world_file.h"

namespace zenith::sim {

struct WheelErrors {
  double left_scale = 1.0;  // report per true travel
  double right_scale = 1.0;
  double track_width_m = 0.4;
};

WheelErrors draw_wheel_errors(const WheelSpec& spec, Random& random);

inline constexpr double kWheelRate_hz = 100.0;

// The bus of the whole run: an odometer (0x311) and a motion frame (0x221) every 10 ms, with
// stamps up to 0.4 ms late. `start` is the time of the run's beginning; the first
// frames come 50 ms before it.
std::vector<CanFrame> drive_wheels(const DrivenPath& path, double duration_s, Time start,
                                   const WheelSpec& spec, const WheelErrors& errors,
                                   Random& random);

}  // namespace zenith::sim
