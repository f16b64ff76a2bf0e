#pragma once
// A line `pose` of the telemetry (docs/daemon.md) as the bridge needs it. Metres, radians, seconds.

#include <array>
#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>

#include "slam/geometry.h"

namespace zenith::ros2 {

// Over (x, y, theta): xx xy xt yy yt tt.
using PlanarCovariance = std::array<double, 6>;

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
std::optional<Motion> read_motion(const nlohmann::json& line, std::int64_t system_offset_ns);

// `stamp_ns` of a line on the system's clock; 0 when there is none.
std::int64_t system_stamp(const nlohmann::json& line, std::int64_t system_offset_ns);

// Three numbers x, y, theta.
std::optional<Pose2> read_pose(const nlohmann::json& numbers);

}  // namespace zenith::ros2
