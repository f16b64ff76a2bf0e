#include "sim/view_angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/image/view.h"

namespace zenith::sim {

double max_view_angle_deg(double given_fov_deg, const RobotConfig& robot) {
  Parameters parameters;
  parameters.rectified_fov_deg = given_fov_deg;
  const double rectified_fov_deg = with_fitted_view(parameters, robot).rectified_fov_deg;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  constexpr double kMargin_deg = 4.0;
  const double half_fov = 0.5 * rectified_fov_deg / kDegrees;
  const double corner = std::atan(std::numbers::sqrt2 * std::tan(half_fov));
  const double tilt = std::acos(
      std::clamp(std::cos(robot.mount.roll_rad) * std::cos(robot.mount.pitch_rad), -1.0, 1.0));
  return std::min(180.0, (corner + tilt) * kDegrees + kMargin_deg);
}

Result<Simulation> load_what_is_seen(const std::filesystem::path& world_toml, SimOptions options,
                                     double rectified_fov_deg) {
  options.max_view_angle_deg = 180.0;
  auto loaded = Simulation::load(world_toml, options);
  if (!loaded.ok()) return loaded.error();
  // The mounts are known only now: load again, with what the cameras need to see.
  double angle = 0.0;
  for (std::size_t robot = 0; robot < loaded->robot_count(); ++robot) {
    angle = std::max(angle, max_view_angle_deg(rectified_fov_deg, loaded->drive(robot).config()));
  }
  options.max_view_angle_deg = angle;
  return Simulation::load(world_toml, options);
}

}  // namespace zenith::sim
