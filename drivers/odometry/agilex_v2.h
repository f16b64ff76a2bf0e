#pragma once
// The AgileX v2 layout (Scout, Bunker, Tracer, Hunter), byte for byte.
//
//   0x221 motion    int16 x4: linear (0.001 m/s), angular (0.001 rad/s), lateral (0.001 m/s),
//                   steering (0.001 rad)
//   0x311 odometer  int32 left, int32 right: travel of each wheel in millimetres since power-up;
//                   both wrap at 32 bits
//
// All integers are big-endian. Both frames have 8 bytes of data and an 11-bit identifier.
// Source: the manufacturer's user manuals, "CAN communication protocol v2".

#include <cstdint>
#include <optional>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec.h"

namespace zenith::agilex_v2 {

inline constexpr std::uint32_t kMotionId = 0x221;
inline constexpr std::uint32_t kOdometerId = 0x311;

struct Odometer {
  std::int32_t left_mm = 0;
  std::int32_t right_mm = 0;
};

struct Motion {
  double linear_mps = 0.0;
  double angular_radps = 0.0;
  double lateral_mps = 0.0;
  double steering_rad = 0.0;
};

// Empty when the frame has another identifier or fewer than 8 bytes.
std::optional<Odometer> decode_odometer(const CanFrame& frame);
std::optional<Motion> decode_motion(const CanFrame& frame);

CanFrame encode_odometer(Time stamp, const Odometer& odometer);
// Rounds to 0.001 and saturates at the ends of int16.
CanFrame encode_motion(Time stamp, const Motion& motion);

// The travel comes from the odometer alone; the motion frame is known and passed over.
struct Codec {
  bool swap_wheels = false;

  WheelNews read(const CanFrame& frame) const;
  WheelScales scales(const WheelGeometry& geometry) const;
  CanIds ids() const;
};

}  // namespace zenith::agilex_v2
