#include "tools/ros2/motion.h"

namespace zenith::ros2 {
namespace {

using nlohmann::json;

const json& at(const json& object, const char* key) {
  static const json kNone;
  if (!object.is_object()) return kNone;
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

template <std::size_t Count>
bool read_numbers(const json& list, std::array<double, Count>& out) {
  if (!list.is_array() || list.size() != Count) return false;
  for (std::size_t i = 0; i < Count; ++i) {
    if (!list[i].is_number()) return false;
    out[i] = list[i].get<double>();
  }
  return true;
}

}  // namespace

std::int64_t system_stamp(const json& line, std::int64_t system_offset_ns) {
  const json& stamp = at(line, "stamp_ns");
  return stamp.is_number_integer() ? stamp.get<std::int64_t>() + system_offset_ns : 0;
}

std::optional<Pose2> read_pose(const json& numbers) {
  std::array<double, 3> p = {};
  if (!read_numbers(numbers, p)) return std::nullopt;
  return Pose2{p[0], p[1], p[2]};
}

std::optional<Motion> read_motion(const json& line, std::int64_t system_offset_ns) {
  const json& odometry = at(line, "odometry");
  const auto T_map_base = read_pose(at(line, "pose"));
  const auto T_odom_base = read_pose(at(odometry, "pose"));
  Motion motion;
  motion.system_ns = system_stamp(line, system_offset_ns);
  if (motion.system_ns == 0 || !T_map_base || !T_odom_base ||
      !read_numbers(at(line, "covariance"), motion.map_covariance) ||
      !read_numbers(at(odometry, "covariance"), motion.odom_covariance) ||
      !read_numbers(at(odometry, "velocity"), motion.velocity) ||
      !read_numbers(at(odometry, "velocity_covariance"), motion.velocity_covariance)) {
    return std::nullopt;
  }
  motion.T_map_base = *T_map_base;
  motion.T_odom_base = *T_odom_base;
  return motion;
}

}  // namespace zenith::ros2
