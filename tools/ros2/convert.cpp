#include "tools/ros2/convert.h"

#include <algorithm>
#include <cmath>

namespace zenith::ros2 {

builtin_interfaces_msg_dds__Time_ to_time(std::int64_t system_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return {static_cast<std::int32_t>(system_ns / kSecond_ns),
          static_cast<std::uint32_t>(system_ns % kSecond_ns)};
}

std_msgs_msg_dds__Header_ to_header(std::int64_t system_ns, const std::string& frame) {
  return {to_time(system_ns), to_text(frame)};
}

geometry_msgs_msg_dds__Quaternion_ to_quaternion(double yaw_rad) {
  return {0.0, 0.0, std::sin(0.5 * yaw_rad), std::cos(0.5 * yaw_rad)};
}

geometry_msgs_msg_dds__Pose_ to_pose(const Pose2& pose) {
  return {{pose.x_m, pose.y_m, 0.0}, to_quaternion(pose.theta_rad)};
}

void put_covariance(const PlanarCovariance& planar, double (&out)[36]) {
  constexpr std::size_t kAxes[] = {0, 1, 5};  // x, y, yaw
  std::fill(std::begin(out), std::end(out), 0.0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      out[6 * kAxes[i] + kAxes[j]] = planar[next];
      out[6 * kAxes[j] + kAxes[i]] = planar[next];
      ++next;
    }
  }
}

}  // namespace zenith::ros2
