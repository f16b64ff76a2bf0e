#pragma once
// Where robots' start frames lie in that of the first one, as far as merges tell.

#include <map>
#include <string>
#include <vector>

#include "slam/geometry.h"
#include "tools/view/robot_state.h"

namespace zenith::tools {

// By name; the first robot lies at the origin, robots that nobody has merged with are missing.
// Peers that do not tell themselves are there, too.
std::map<std::string, Pose2> place_starts(const std::vector<RobotState>& robots);

}  // namespace zenith::tools
