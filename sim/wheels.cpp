#include "sim/wheels.h"

#include <cmath>

#include "drivers/odometry/agilex_v2.h"

namespace zenith::sim {
namespace {

constexpr double kDriftTime_s = 20.0;
constexpr double kEventTime_s = 0.2;
constexpr double kMaxDelay_s = 0.0004;

class Wheel {
 public:
  Wheel(const WheelSpec& spec, double scale, Random& random)
      : spec_(spec), scale_(scale), drift_(spec.drift_sigma * random.normal()) {}

  // Advances by the true travel of `dt`; returns what the wheel's counter gains.
  double turn(double travel_m, double dt, Random& random) {
    const double decay = dt / kDriftTime_s;
    drift_ += -decay * drift_ + spec_.drift_sigma * std::sqrt(2.0 * decay) * random.normal();
    const double distance = std::abs(travel_m);
    if (random.uniform() < spec_.slip_events_per_m * distance) {
      event_left_m_ = random.uniform(0.01, 0.04);
      event_rate_mps_ = event_left_m_ / kEventTime_s;
    }
    const double event = std::min(event_left_m_, event_rate_mps_ * dt);
    event_left_m_ -= event;
    const double slip = spec_.slip_sigma_per_sqrt_m * std::sqrt(distance) * random.normal();
    return travel_m * (scale_ + drift_) + slip + std::copysign(event, travel_m);
  }

 private:
  const WheelSpec& spec_;
  double scale_;
  double drift_;
  double event_left_m_ = 0.0;
  double event_rate_mps_ = 0.0;
};

std::int32_t whole_mm(double start_mm, double travel_m) {
  const auto mm = static_cast<std::int64_t>(std::floor(start_mm + 1000.0 * travel_m));
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(mm));  // wraps as a base's does
}

}  // namespace

WheelErrors draw_wheel_errors(const WheelSpec& spec, Random& random) {
  WheelErrors errors;
  const double both = spec.scale_sigma * random.normal();
  const double half_difference = 0.5 * spec.unequal_sigma * random.normal();
  errors.left_scale = 1.0 + both + half_difference;
  errors.right_scale = 1.0 + both - half_difference;
  errors.track_width_m = spec.track_width_m * (1.0 + spec.track_sigma * random.normal());
  return errors;
}

std::vector<CanFrame> drive_wheels(const DrivenPath& path, double duration_s, Time start,
                                   const WheelSpec& spec, const WheelErrors& errors,
                                   Random& random) {
  Wheel left(spec, errors.left_scale, random);
  Wheel right(spec, errors.right_scale, random);
  // The base has been on for a while: its counters start anywhere.
  const double left_start_mm = random.uniform(-1e6, 1e6);
  const double right_start_mm = random.uniform(-1e6, 1e6);
  const double dt = DrivenPath::kStep_s;
  const int steps_per_frame = static_cast<int>(std::lround(1.0 / (kWheelRate_hz * dt)));
  const auto frames = static_cast<int>(std::ceil(duration_s * kWheelRate_hz)) + 2;
  double left_m = 0.0;
  double right_m = 0.0;
  double reported_left_before = 0.0;
  double reported_right_before = 0.0;
  std::vector<CanFrame> bus;
  bus.reserve(2 * static_cast<std::size_t>(frames + 8));
  // The bus talks before the first camera frame does.
  const int kEarlier = 5 + static_cast<int>(0.1 * spec.latency_ms);
  for (int frame = -kEarlier; frame < frames; ++frame) {
    const double time_s = frame / kWheelRate_hz;
    const Time stamp = start + Duration::from_seconds(time_s + 1e-3 * spec.latency_ms +
                                                      random.uniform(0.0, kMaxDelay_s));
    bus.push_back(agilex_v2::encode_odometer(
        stamp, {whole_mm(left_start_mm, left_m), whole_mm(right_start_mm, right_m)}));
    const double v_left = (left_m - reported_left_before) * kWheelRate_hz;
    const double v_right = (right_m - reported_right_before) * kWheelRate_hz;
    reported_left_before = left_m;
    reported_right_before = right_m;
    bus.push_back(agilex_v2::encode_motion(
        stamp + Duration{60'000},
        {0.5 * (v_left + v_right), (v_right - v_left) / spec.track_width_m, 0.0, 0.0}));
    for (int step = 0; step < steps_per_frame; ++step) {
      const DriveState state = path.at(time_s + (step + 0.5) * dt);
      const double turn = 0.5 * errors.track_width_m * state.turn_radps;
      left_m += left.turn((state.speed_mps - turn) * dt, dt, random);
      right_m += right.turn((state.speed_mps + turn) * dt, dt, random);
    }
  }
  return bus;
}

}  // namespace zenith::sim
