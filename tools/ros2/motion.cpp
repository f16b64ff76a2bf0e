#include "tools/ros2/motion.h"

namespace zenith::ros2 {

std::int64_t system_stamp(const tools::TelemetryLine& line, std::int64_t system_offset_ns) {
  constexpr std::int64_t kEnd_ns = std::int64_t{INT32_MAX} * 1'000'000'000;
  const std::int64_t stamp = line.stamp_ns();
  if (stamp <= 0 || stamp > kEnd_ns || system_offset_ns > kEnd_ns - stamp) return 0;
  return stamp + system_offset_ns;
}

std::optional<Motion> read_motion(const tools::TelemetryLine& line, std::int64_t system_offset_ns) {
  const auto* pose = line.as<tools::PoseLine>();
  if (pose == nullptr || !pose->covariance || !pose->odometry) return std::nullopt;
  Motion motion;
  motion.system_ns = system_stamp(line, system_offset_ns);
  if (motion.system_ns == 0) return std::nullopt;
  motion.T_map_base = pose_of(pose->pose);
  motion.map_covariance = *pose->covariance;
  motion.T_odom_base = pose_of(pose->odometry->pose);
  motion.odom_covariance = pose->odometry->covariance;
  motion.velocity = pose->odometry->velocity;
  motion.velocity_covariance = pose->odometry->velocity_covariance;
  return motion;
}

}  // namespace zenith::ros2
