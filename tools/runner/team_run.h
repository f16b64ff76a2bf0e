#pragma once
// Runs a team in one process: every robot its own Slam, frames in the order of their stamps, and
// after each step the robot's new records go to all others at once, rounded as on the wire. A
// network without faults.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "platform/base/result.h"
#include "platform/recording/source.h"
#include "slam/parameters.h"
#include "tools/runner/run_log.h"
#include "tools/runner/team.h"

namespace zenith::tools {

// Called after every step of a robot.
using AfterStep = std::function<void(std::size_t robot, Member& member)>;

struct RunOptions {
  Parameters parameters;
  std::uint64_t seed = 1;
  MapSharing sharing = MapSharing::kAsSent;
  bool joint = false;  // aligned robots go on in one filter; see joint_run.h
  AfterStep after_step = {};
};

// Called after every frame with the frames done and the frames in all.
using RunProgress = std::function<void(int done, int total)>;

// Deterministic but for the step times. Stops at the first source that fails.
Result<TeamLog> run_team(std::span<const std::unique_ptr<Source>> sources,
                         const RunOptions& options, const RunProgress& progress);

}  // namespace zenith::tools
