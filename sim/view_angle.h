#pragma once
// Rendering only what a robot's rectified image can see.

#include "sim/simulation.h"
#include "slam/robot.h"

namespace zenith::sim {

// From the optical axis to the farthest direction that the rectified image shows, for a camera
// that is tilted as in `robot`: corner of the image, tilt, and a margin. The field may be
// kFittedView.
double max_view_angle_deg(double rectified_fov_deg, const RobotConfig& robot);

// Simulation::load() with the least view angle that serves all robots of the world.
Result<Simulation> load_what_is_seen(const std::filesystem::path& world_toml, SimOptions options,
                                     double rectified_fov_deg);

}  // namespace zenith::sim
