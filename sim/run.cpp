// Decides one robot's run from the seed: way-points, motion, calibration, wheels.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/seed.h"
#include "sim/world.h"

namespace zenith::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kFirstRest_s = 1.0;
constexpr int kPathAttempts = 8;

// What is true where the calibration says something else.
RobotConfig draw_truth(const RobotConfig& believed, const CalibrationError& error, Random& random) {
  RobotConfig truth = believed;
  truth.lens.cu_px += error.principal_px * random.normal();
  truth.lens.cv_px += error.principal_px * random.normal();
  const double focal = 1.0 + error.focal_relative * random.normal();
  truth.lens.fu_px *= focal;
  truth.lens.fv_px *= focal;
  truth.mount.roll_rad += error.tilt_deg * kRadPerDeg * random.normal();
  truth.mount.pitch_rad += error.tilt_deg * kRadPerDeg * random.normal();
  truth.mount.yaw_rad += error.yaw_deg * kRadPerDeg * random.normal();
  truth.mount.x_m += error.lever_m * random.normal();
  truth.mount.y_m += error.lever_m * random.normal();
  return truth;
}

bool stays_free(const DrivenPath& path, const FloorPlan& plan) {
  for (double t = 0.0; t <= path.duration_s(); t += 0.1) {
    if (!plan.is_free(path.at(t).pose.position(), kRobotRadius_m)) return false;
  }
  return true;
}

}  // namespace

Result<Run> plan_run(const WorldFile& file, const FloorPlan& plan, std::size_t robot,
                     std::uint64_t seed, const SimOptions& options) {
  const RobotSpec& spec = file.robots[robot];
  DriveLimits limits;
  limits.speed_mps = spec.speed_mps;
  RobotSpec calmer = spec;
  for (int attempt = 0; attempt < kPathAttempts; ++attempt) {
    Random random = random_stream(seed, "path", robot * kPathAttempts + attempt);
    // A draw that would graze a wall is drawn again, calmer each time.
    std::vector<Eigen::Vector2d> waypoints = jittered(calmer, random);
    calmer.jitter_m *= 0.8;
    const Eigen::Vector2d ahead = waypoints[1] - waypoints[0];
    double heading = std::atan2(ahead.y(), ahead.x()) + 0.15 * random.normal();
    if (spec.has_start_heading) {
      heading = spec.start_heading_deg * kRadPerDeg + 0.15 * random.normal();
    }
    DrivenPath path(waypoints, heading, limits, kFirstRest_s + spec.start_delay_s, random);
    if (!stays_free(path, plan)) continue;
    RobotConfig believed;
    believed.lens = file.camera.lens;
    believed.mount = file.camera.mount;
    believed.wheels.track_width_m = file.wheels.track_width_m;
    believed.frame_rate_hz = file.frame_rate_hz;
    Random calibration = random_stream(seed, "calibration", robot);
    Random wheels = random_stream(seed, "wheel errors", robot);
    RobotConfig truth = draw_truth(believed, file.calibration_error, calibration);
    const WheelErrors errors = draw_wheel_errors(file.wheels, wheels);
    truth.wheels = {errors.track_width_m, 1.0 / errors.left_scale, 1.0 / errors.right_scale};
    double duration = path.duration_s();
    if (options.max_duration_s > 0.0) duration = std::min(duration, options.max_duration_s);
    return Run{std::move(waypoints), std::move(path), duration, believed, truth, errors};
  }
  return Error{file.name + ".toml:" + std::to_string(spec.line) + ": robot \"" + spec.name +
               "\" would come nearer than 0.25 m to a wall; move its way-points"};
}

}  // namespace zenith::sim
