#pragma once
// A loaded world: what all of its robots share. Read-only after load.

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/floor_plan.h"
#include "sim/path.h"
#include "sim/scene.h"
#include "sim/simulation.h"
#include "sim/wheels.h"
#include "sim/world_file.h"

namespace zenith::sim {

inline constexpr std::int64_t kFirstStamp_ns = 1'000'000'000;

// One robot's run as decided by the seed.
struct Run {
  std::vector<Eigen::Vector2d> waypoints;
  DrivenPath path;
  double duration_s = 0.0;
  RobotConfig believed;
  RobotConfig truth;
  WheelErrors wheel_errors;
};

struct World {
  WorldFile file;
  SimOptions options;
  std::uint64_t seed = 0;  // of the world file and of the options
  FloorPlan plan;
  std::unique_ptr<const Scene> lit;   // when a robot drives with the lamps on
  std::unique_ptr<const Scene> dark;  // when one drives with the lamps off
  std::vector<Run> runs;
};

// Fails when a robot's way would come nearer than this to a wall.
inline constexpr double kRobotRadius_m = 0.25;

Result<Run> plan_run(const WorldFile& file, const FloorPlan& plan, std::size_t robot,
                     std::uint64_t seed, const SimOptions& options);

}  // namespace zenith::sim
