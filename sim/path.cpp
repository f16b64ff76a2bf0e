#include "sim/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zenith::sim {
namespace {

// Progress along a poly-line: the point nearest to the robot, moving forward only.
class PolyLine {
 public:
  explicit PolyLine(const std::vector<Eigen::Vector2d>& points) : points_(points) {
    lengths_.push_back(0.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
      lengths_.push_back(lengths_.back() + (points[i] - points[i - 1]).norm());
    }
  }

  double length() const { return lengths_.back(); }

  Eigen::Vector2d at(double s) const {
    const auto after = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
    const auto i = static_cast<std::size_t>(std::distance(lengths_.begin(), after));
    const double part = std::max(1e-9, lengths_[i] - lengths_[i - 1]);
    const double f = std::clamp((s - lengths_[i - 1]) / part, 0.0, 1.0);
    return points_[i - 1] + f * (points_[i] - points_[i - 1]);
  }

  // The nearest place in [s, s + window].
  double advance(double s, const Eigen::Vector2d& position, double window) const {
    constexpr double kStep_m = 0.01;
    double best = s;
    double best_distance = (at(s) - position).squaredNorm();
    for (double q = s + kStep_m; q <= std::min(s + window, length()); q += kStep_m) {
      const double distance = (at(q) - position).squaredNorm();
      if (distance < best_distance) {
        best_distance = distance;
        best = q;
      }
    }
    return best;
  }

 private:
  const std::vector<Eigen::Vector2d>& points_;
  std::vector<double> lengths_;
};

double towards(double value, double target, double step) {
  return value + std::clamp(target - value, -step, step);
}

struct Command {
  double speed_mps;
  double turn_radps;
};

// `spinning` keeps the decision to turn on the spot until the robot looks ahead again.
Command pursue(const DriveState& state, const Eigen::Vector2d& target, double remaining_m,
               double speed_factor, const DriveLimits& limits, bool& spinning) {
  const Eigen::Vector2d to = target - state.pose.position();
  const double heading_error = wrap_angle(std::atan2(to.y(), to.x()) - state.pose.theta_rad);
  spinning = std::abs(heading_error) > (spinning ? 0.15 : 0.9);
  if (spinning) {
    // Brakes early enough to end the turn at rest.
    const double stop =
        std::sqrt(2.0 * limits.turn_acceleration_radps2 * 0.6 * std::abs(heading_error));
    const double turn = std::min(limits.turn_radps, stop);
    return {0.0, heading_error > 0.0 ? turn : -turn};
  }
  const double curvature = 2.0 * std::sin(heading_error) / std::max(0.15, to.norm());
  double speed = limits.speed_mps * speed_factor;
  speed = std::min(speed, limits.turn_radps / std::max(1e-3, std::abs(curvature)));
  speed = std::min(speed, std::sqrt(2.0 * 0.8 * limits.acceleration_mps2 * remaining_m));
  return {speed, std::clamp(speed * curvature, -limits.turn_radps, limits.turn_radps)};
}

void integrate(DriveState& state, double dt) {
  const double middle = state.pose.theta_rad + 0.5 * dt * state.turn_radps;
  state.pose.x_m += dt * state.speed_mps * std::cos(middle);
  state.pose.y_m += dt * state.speed_mps * std::sin(middle);
  state.pose.theta_rad += dt * state.turn_radps;  // not wrapped: interpolation needs it smooth
}

}  // namespace

DrivenPath::DrivenPath(const std::vector<Eigen::Vector2d>& waypoints, double start_heading_rad,
                       const DriveLimits& limits, double rest_s, Random& random) {
  const PolyLine line(waypoints);
  DriveState state;
  state.pose = {waypoints.front().x(), waypoints.front().y(), start_heading_rad};
  const auto steps = [](double s) { return static_cast<std::size_t>(std::lround(s / kStep_s)); };
  states_.assign(steps(rest_s) + 1, state);
  // A person's hand on the stick: the speed wanders slowly.
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double period_s = random.uniform(7.0, 13.0);
  constexpr int kControlEvery = 10;
  constexpr double kArrived_m = 0.03;
  double s = 0.0;
  bool spinning = false;
  Command command = {0.0, 0.0};
  for (std::size_t step = 0; step < steps(kMaxDuration_s); ++step) {
    if (step % kControlEvery == 0) {
      s = line.advance(s, state.pose.position(), 0.3);
      const double remaining = line.length() - s;
      if (remaining < kArrived_m && std::abs(state.speed_mps) < 0.02) break;
      const double time = static_cast<double>(step) * kStep_s;
      const double factor =
          0.92 + 0.08 * std::sin(2.0 * std::numbers::pi * time / period_s + phase);
      command = pursue(state, line.at(s + limits.lookahead_m), remaining, factor, limits, spinning);
      if (remaining < kArrived_m) command = {0.0, 0.0};
    }
    state.speed_mps =
        towards(state.speed_mps, command.speed_mps, limits.acceleration_mps2 * kStep_s);
    state.turn_radps =
        towards(state.turn_radps, command.turn_radps, limits.turn_acceleration_radps2 * kStep_s);
    integrate(state, kStep_s);
    states_.push_back(state);
  }
  // Comes to rest within the limits, then stands.
  for (std::size_t step = 0; step < steps(1.0); ++step) {
    state.speed_mps = towards(state.speed_mps, 0.0, limits.acceleration_mps2 * kStep_s);
    state.turn_radps = towards(state.turn_radps, 0.0, limits.turn_acceleration_radps2 * kStep_s);
    integrate(state, kStep_s);
    states_.push_back(state);
  }
}

DriveState DrivenPath::at(double time_s) const {
  const double at = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(states_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), states_.size() - 1);
  const DriveState& a = states_[i];
  const DriveState& b = states_[std::min(i + 1, states_.size() - 1)];
  const double f = at - static_cast<double>(i);
  const auto mix = [f](double p, double q) { return p + f * (q - p); };
  return {{mix(a.pose.x_m, b.pose.x_m), mix(a.pose.y_m, b.pose.y_m),
           mix(a.pose.theta_rad, b.pose.theta_rad)},
          mix(a.speed_mps, b.speed_mps),
          mix(a.turn_radps, b.turn_radps)};
}

std::vector<Eigen::Vector2d> jittered(const RobotSpec& robot, Random& random) {
  std::vector<Eigen::Vector2d> points = robot.path;
  for (Eigen::Vector2d& point : points) {
    const double dx = random.uniform(-robot.jitter_m, robot.jitter_m);
    const double dy = random.uniform(-robot.jitter_m, robot.jitter_m);
    point += Eigen::Vector2d(dx, dy);
  }
  return points;
}

}  // namespace zenith::sim
