#pragma once
// The travel of one wheel out of its readings, whatever the base sends:
//
//   counter    travel += unit * (count - previous count), modulo 2^bits: a wrap is a step
//   position   travel += unit * (value - previous value)
//   velocity   travel += unit * (value + previous value) / 2 * time between, at most
//   max_velocity_gap
//
// Restarts. A step that no wheel can make (faster than max_speed since the last reading, and after
// a silence longer than max_gap more than max_speed * max_gap) is a restart of the base: travel
// goes on from where it was, without motion. So is a position that reads exactly zero after half a
// second of silence and did not before: bases are quiet for longer while they start. Lost frames
// of counters and positions cost nothing, those of velocities the motion beyond the bounded gap.
//
// Plain data, no heap, no lock.

#include <cstdint>

#include "drivers/odometry/wheel_codec.h"
#include "platform/base/time.h"

namespace zenith {

struct WheelLimits {
  double max_speed_mps = 5.0;
  double max_gap_s = 2.0;
  double max_velocity_gap_s = 0.25;
};

enum class WheelStep {
  kFirst,      // the first reading: travel is zero there
  kMoved,      // or stood still
  kRestarted,  // an impossible step
  kLate,       // not newer than the last reading: a duplicate, or out of order
  kInvalid,    // not a number, or a velocity above max_speed
};

class WheelAccumulator {
 public:
  WheelAccumulator(const WheelScale& scale, const WheelLimits& limits)
      : scale_(scale), limits_(limits) {}

  // What the reading would be; changes nothing.
  WheelStep judge(Time stamp, const WheelReading& reading) const;
  // From the last taken reading to this one, in the base's units; of velocities, the reading. 0 for
  // the first position.
  double step_units(const WheelReading& reading) const;
  // Long enough without a reading for a base to have restarted.
  bool was_silent(Time stamp) const;
  // A velocity after a silence longer than max_velocity_gap.
  bool ends_velocity_gap(Time stamp) const;
  // Takes a reading that is kFirst, kMoved or kRestarted. The caller may call a step a restart
  // because the other wheel's was.
  void take(Time stamp, const WheelReading& reading, WheelStep step);

  // Of the last taken reading.
  Time stamp() const { return last_.stamp; }
  // On the straight line between the last two taken readings; outside of them, the nearer one's.
  double travel_at(Time stamp) const;

 private:
  struct Mark {
    Time stamp;
    double travel_m = 0.0;
  };

  bool is_restart(Time stamp, const WheelReading& reading) const;
  std::int64_t counter_step(std::uint64_t count) const;
  double travel_m() const;

  WheelScale scale_;
  WheelLimits limits_;
  bool started_ = false;
  WheelReading reading_;  // the last taken one
  Mark last_;
  Mark before_;
  std::int64_t total_counts_ = 0;  // kCounter: exact
  double total_units_ = 0.0;       // kPosition, kVelocity
};

}  // namespace zenith
