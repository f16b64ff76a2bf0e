#include "drivers/odometry/wheel_accumulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zenith {
namespace {

// Counters move in whole units and stamps carry jitter: two frames close together may show a step
// that their stamps alone would forbid.
constexpr double kStepSlack_m = 0.010;
constexpr double kStepSlackUnits = 2.0;
// No base is back sooner after its power was cut.
constexpr double kRestartSilence_s = 0.5;

}  // namespace

std::int64_t WheelAccumulator::counter_step(std::uint64_t count) const {
  const int unused = 64 - scale_.counter_bits;
  return static_cast<std::int64_t>((count - reading_.count) << unused) >> unused;
}

double WheelAccumulator::step_units(const WheelReading& reading) const {
  if (scale_.kind == WheelKind::kVelocity) return reading.value;
  if (!started_) return 0.0;
  return scale_.kind == WheelKind::kCounter ? static_cast<double>(counter_step(reading.count))
                                            : reading.value - reading_.value;
}

bool WheelAccumulator::was_silent(Time stamp) const {
  return started_ && (stamp - last_.stamp).seconds() >= kRestartSilence_s;
}

bool WheelAccumulator::is_restart(Time stamp, const WheelReading& reading) const {
  const bool counter = scale_.kind == WheelKind::kCounter;
  const double step_m = std::abs(step_units(reading) * scale_.metres_per_unit);
  const double slack_m =
      std::max(kStepSlack_m, counter ? kStepSlackUnits * std::abs(scale_.metres_per_unit) : 0.0);
  const double silence_s = (stamp - last_.stamp).seconds();
  if (!(step_m <= limits_.max_speed_mps * std::min(silence_s, limits_.max_gap_s) + slack_m)) {
    return true;
  }
  const bool zero = counter ? reading.count == 0 : reading.value == 0.0;
  return zero && silence_s >= kRestartSilence_s && step_m > slack_m;
}

WheelStep WheelAccumulator::judge(Time stamp, const WheelReading& reading) const {
  const bool velocity = scale_.kind == WheelKind::kVelocity;
  if (started_ && stamp <= last_.stamp) return WheelStep::kLate;
  if (scale_.kind != WheelKind::kCounter && !std::isfinite(reading.value)) {
    return WheelStep::kInvalid;
  }
  if (velocity && std::abs(reading.value * scale_.metres_per_unit) > limits_.max_speed_mps) {
    return WheelStep::kInvalid;
  }
  if (!started_) return WheelStep::kFirst;
  return !velocity && is_restart(stamp, reading) ? WheelStep::kRestarted : WheelStep::kMoved;
}

bool WheelAccumulator::ends_velocity_gap(Time stamp) const {
  return started_ && scale_.kind == WheelKind::kVelocity &&
         (stamp - last_.stamp).seconds() > limits_.max_velocity_gap_s;
}

void WheelAccumulator::take(Time stamp, const WheelReading& reading, WheelStep step) {
  assert(step != WheelStep::kLate && step != WheelStep::kInvalid);
  if (step == WheelStep::kMoved) {
    const double silence_s = (stamp - last_.stamp).seconds();
    switch (scale_.kind) {
      case WheelKind::kCounter:
        total_counts_ += counter_step(reading.count);
        break;
      case WheelKind::kPosition:
        total_units_ += reading.value - reading_.value;
        break;
      case WheelKind::kVelocity:
        total_units_ += 0.5 * (reading_.value + reading.value) *
                        std::min(silence_s, limits_.max_velocity_gap_s);
        break;
    }
  }
  before_ = step == WheelStep::kFirst ? Mark{stamp, 0.0} : last_;
  reading_ = reading;
  started_ = true;
  last_ = {stamp, travel_m()};
}

double WheelAccumulator::travel_m() const {
  const bool counter = scale_.kind == WheelKind::kCounter;
  return scale_.metres_per_unit * (counter ? static_cast<double>(total_counts_) : total_units_);
}

double WheelAccumulator::travel_at(Time stamp) const {
  if (stamp >= last_.stamp) return last_.travel_m;
  if (stamp <= before_.stamp) return before_.travel_m;
  const double part = (stamp - before_.stamp).seconds() / (last_.stamp - before_.stamp).seconds();
  return before_.travel_m + part * (last_.travel_m - before_.travel_m);
}

}  // namespace zenith
