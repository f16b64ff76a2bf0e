#pragma once
// A simulated drive as a source, rendered frame by frame: nothing is written to disk.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/source.h"
#include "slam/parameters.h"

namespace zenith::tools {

struct SimulatedTeam {
  std::string world;
  std::vector<std::unique_ptr<Source>> sources;
};

// Only what the rectified image can see is rendered. `duration_s` 0: as long as the world says.
Result<SimulatedTeam> simulate_team(const std::string& world, std::uint64_t seed, double duration_s,
                                    const Parameters& parameters);

}  // namespace zenith::tools
