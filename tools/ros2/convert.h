#pragma once
// From the plane into ROS 2's messages. Those are C structs with pointers: texts and lists that are
// put into one must outlive it, and nobody may free it.

#include <cstdint>
#include <string>
#include <vector>

#include <zenith_ros2_idl/geometry_msgs.h>

#include "tools/ros2/motion.h"

namespace zenith::ros2 {

builtin_interfaces_msg_dds__Time_ to_time(std::int64_t system_ns);
std_msgs_msg_dds__Header_ to_header(std::int64_t system_ns, const std::string& frame);
geometry_msgs_msg_dds__Quaternion_ to_quaternion(double yaw_rad);
geometry_msgs_msg_dds__Pose_ to_pose(const Pose2& pose);

// Row-major 6x6 over (x, y, z, roll, pitch, yaw). What is out of the plane is exactly zero: the
// floor is flat.
void put_covariance(const PlanarCovariance& planar, double (&out)[36]);

inline char* to_text(const std::string& text) {
  return const_cast<char*>(text.c_str());  // the struct is only read
}

template <typename Sequence, typename Item>
Sequence to_sequence(const std::vector<Item>& items) {
  Sequence sequence = {};
  sequence._maximum = sequence._length = static_cast<std::uint32_t>(items.size());
  sequence._buffer = const_cast<Item*>(items.data());  // the struct is only read
  sequence._release = false;
  return sequence;
}

}  // namespace zenith::ros2
