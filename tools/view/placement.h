#pragma once
// Where robots' start frames lie in that of one of them, as far as merges tell.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry.h"
#include "tools/view/robot_state.h"

namespace zenith::tools {

// A robot's own maps of earlier runs, as zenithd calls them: the one that it goes on with, one for
// each robot, and what was cut short before, of which there may be several.
inline constexpr std::string_view kPastSelf = "past self";
inline constexpr std::string_view kEarlierSession = "earlier session";

// By name; the robot `first` lies at the origin, robots that nobody has merged with are missing.
// Peers that do not tell themselves are there, too, and a robot's stored map as "anna past self";
// its earlier sessions are not.
std::map<std::string, Pose2> place_starts(const std::vector<RobotState>& robots,
                                          std::size_t first = 0);

}  // namespace zenith::tools
