#pragma once
// The true motion of a differential drive along way-points.
//
// A pure-pursuit driver steers at a point ahead on the poly-line, turns on the spot when it looks
// the wrong way, keeps to limits of speed and acceleration, and stops at the end. The kinematic
// model is integrated at 1 kHz:  dx = v cos(theta) dt,  dy = v sin(theta) dt,  dtheta = w dt.
// Source: Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", 1992.

#include <vector>

#include <Eigen/Core>

#include "platform/base/random.h"
#include "sim/world_file.h"
#include "slam/geometry.h"

namespace zenith::sim {

struct DriveLimits {
  double speed_mps = 0.5;
  double acceleration_mps2 = 0.5;
  double turn_radps = 0.9;
  double turn_acceleration_radps2 = 2.0;
  double lookahead_m = 0.45;
};

struct DriveState {
  Pose2 pose;
  double speed_mps = 0.0;
  double turn_radps = 0.0;
};

// The states at 1 kHz from time 0 of the run.
class DrivenPath {
 public:
  static constexpr double kStep_s = 0.001;
  static constexpr double kMaxDuration_s = 1200.0;

  // Stands still for `rest_s` first and for one second at the end.
  DrivenPath(const std::vector<Eigen::Vector2d>& waypoints, double start_heading_rad,
             const DriveLimits& limits, double rest_s, Random& random);

  double duration_s() const { return kStep_s * static_cast<double>(states_.size() - 1); }
  // Interpolated; clamped to the run.
  DriveState at(double time_s) const;

 private:
  std::vector<DriveState> states_;
};

// The way-points of a robot for one seed: each moves by up to jitter_m in x and y.
std::vector<Eigen::Vector2d> jittered(const RobotSpec& robot, Random& random);

}  // namespace zenith::sim
