#pragma once
// What topics and frames are called: ROS 2's topic prefix, a robot's name where there are several,
// and the frames of REP-105.

#include <string>
#include <string_view>

namespace zenith::ros2 {

// A name as ROS 2 allows it in topics: letters, digits and single underscores, no digit first.
// Others become underscores, and eight digits of the name's hash follow, so that names which differ
// stay apart: "robot-7" is robot_7_xxxxxxxx, always the same. "past self", what zenithd calls a
// robot's map of an earlier run, is past_self; a robot that calls itself so gets the digits.
std::string ros_name(std::string_view name);

struct FrameNames {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";
};

class RobotNames {
 public:
  // `prefixed`: topics and frames begin with the robot's name.
  RobotNames(std::string_view robot, const FrameNames& frames, bool prefixed);

  const std::string& robot() const { return robot_; }
  // "odom": the DDS topic "rt/odom" or "rt/anna/odom", which ROS 2 shows as /odom or /anna/odom.
  std::string topic(std::string_view name) const;
  std::string map() const { return prefix_ + frames_.map; }
  std::string odom() const { return prefix_ + frames_.odom; }
  std::string base() const { return prefix_ + frames_.base; }
  // Another robot's map frame: always with its name.
  std::string map_of(std::string_view other) const;

 private:
  std::string robot_;
  std::string prefix_;  // "anna/", or empty
  FrameNames frames_;
};

}  // namespace zenith::ros2
