#include "tools/ros2/names.h"

namespace zenith::ros2 {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_plain(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string ros_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const char put = is_plain(c) ? c : '_';
    if (put == '_' && !out.empty() && out.back() == '_') continue;
    out += put;
  }
  if (out.empty()) return "robot";
  return is_digit(out[0]) ? "r" + out : out;
}

RobotNames::RobotNames(std::string_view robot, const FrameNames& frames, bool prefixed)
    : robot_(ros_name(robot)), prefix_(prefixed ? robot_ + "/" : ""), frames_(frames) {}

std::string RobotNames::topic(std::string_view name) const {
  return "rt/" + prefix_ + std::string(name);
}

std::string RobotNames::map_of(std::string_view other) const {
  return ros_name(other) + "/" + frames_.map;
}

}  // namespace zenith::ros2
