#pragma once
// ROS 2's hash of a message's description (REP-2011, RIHS01), computed from the bridge's IDL: what
// the fields are called, in which order, of which type. Comments and defaults are no part of it.

#include <string>

namespace zenith::ros2 {

// `type` as ROS 2 has it: "nav_msgs/msg/Odometry"; from the files in `folder`.
std::string type_hash(const std::string& folder, const std::string& type);

}  // namespace zenith::ros2
