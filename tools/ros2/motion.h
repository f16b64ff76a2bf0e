#pragma once
// A line `pose` of the telemetry (docs/daemon.md) as the bridge needs it. Metres, radians, seconds.

#include <array>
#include <cstdint>
#include <optional>

#include "slam/geometry.h"
#include "tools/view/telemetry_line.h"

namespace zenith::ros2 {

// Over (x, y, theta): xx xy xt yy yt tt.
using PlanarCovariance = tools::CovarianceNumbers;

struct Motion {
  std::int64_t system_ns = 0;  // of the frame, on the system's clock (CLOCK_REALTIME)
  Pose2 T_map_base;            // jumps when a loop closes
  PlanarCovariance map_covariance = {};
  Pose2 T_odom_base;  // the wheels alone: continuous
  PlanarCovariance odom_covariance = {};
  std::array<double, 3> velocity = {};  // of base_link, in it: forward, left, turn
  PlanarCovariance velocity_covariance = {};

  Pose2 T_map_odom() const { return T_map_base * T_odom_base.inverse(); }
};

// `system_offset_ns` is what `hello` and `health` tell. Nothing when a number is missing.
std::optional<Motion> read_motion(const tools::TelemetryLine& line, std::int64_t system_offset_ns);

// `stamp_ns` of a line on the system's clock; 0 when there is none, or it is none of ROS 2's times,
// which end in 2038.
std::int64_t system_stamp(const tools::TelemetryLine& line, std::int64_t system_offset_ns);

inline Pose2 pose_of(const tools::PlanarNumbers& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace zenith::ros2
