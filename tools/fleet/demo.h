#pragma once
// The robots of a world as real daemons (zenithd-sim) that exchange their maps over UDP, watched
// over the same radio.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "tools/runner/run_log.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {

struct FleetDemo {
  std::string world;
  std::uint64_t seed = 1;
  double duration_s = 0.0;  // at most; 0: until all robots have driven their ways
  // Called when all daemons run, with their telemetry sockets.
  std::function<Status(const std::vector<RobotAddress>&)> on_start = {};
  // Asked twice a second: whether to give up.
  std::function<bool()> stopped = {};
};

// Where zenithd-sim is: $ZENITHD_SIM, beside this program, or where the build puts it.
Result<std::filesystem::path> find_simulated_daemon();

// Configurations, key and logs go into `folder`. Progress is printed. The log has the robots'
// poses, landmarks and alignments as they told them; the truth at the first frame alone.
Result<TeamLog> run_fleet_demo(const FleetDemo& demo, const std::filesystem::path& folder);

}  // namespace zenith::tools
