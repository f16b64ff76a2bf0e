#pragma once
// ODrive's CANSimple protocol, byte for byte. Each wheel has its own node; 11-bit identifiers are
// node << 5 | command.
//
//   0x001 heartbeat          uint32 axis error, uint8 axis state (firmware's own bytes follow)
//   0x009 encoder estimates  float32 position (turns), float32 velocity (turns/s)
//
// All values are little-endian. The position does not wrap; a float32 resolves a thousandth of a
// turn up to 8000 turns. It restarts at zero with the drive.
// Source: ODrive's documentation, "CANSimple protocol"; both messages are cyclic.

#include <cstdint>
#include <optional>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec.h"

namespace zenith::odrive {

inline constexpr std::uint32_t kMaxNode = 0x3F;

struct Config {
  std::uint32_t left_node = 0;
  std::uint32_t right_node = 1;
  WheelQuantity quantity = WheelQuantity::kPosition;
};

struct Estimates {
  float position_turns = 0.0F;
  float velocity_turns_per_s = 0.0F;
};

struct Heartbeat {
  std::uint32_t axis_error = 0;
  std::uint8_t axis_state = 0;
};

// Empty when the frame has another identifier or too few bytes.
std::optional<Estimates> decode_estimates(const CanFrame& frame, std::uint32_t node);
std::optional<Heartbeat> decode_heartbeat(const CanFrame& frame, std::uint32_t node);

CanFrame encode_estimates(Time stamp, std::uint32_t node, const Estimates& estimates);
CanFrame encode_heartbeat(Time stamp, std::uint32_t node, const Heartbeat& heartbeat);

struct Codec {
  Config config;

  WheelNews read(const CanFrame& frame) const;
  WheelScales scales(const WheelGeometry& geometry) const;
  CanIds ids() const;
};

}  // namespace zenith::odrive
