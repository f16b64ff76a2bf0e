#pragma once
// CANopen (CiA 301, CiA 402): each wheel's position or velocity out of a transmit PDO.
//
//   COB-ID   11 bits; TPDO1..4 are by default 0x180, 0x280, 0x380, 0x480 + node
//   object   0x6064 position actual value, or 0x606C velocity actual value: 2 or 4 bytes at an
//            offset in the PDO, little-endian
//
// The mapping is configuration, here and in the drive. Both wheels may share one PDO, or come from
// one node each. Positions wrap at their mapped length. The units of both objects are the drive's
// own: `units_per_turn` says how many make one turn of the motor, for velocities the reading at one
// turn per second (60 when the drive reports rpm, 600 for tenths of rpm).

#include <cstdint>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec.h"

namespace zenith::canopen {

struct Mapping {
  std::uint32_t cob_id = 0;
  std::uint32_t byte_offset = 0;
  std::uint32_t byte_length = 4;  // 2 or 4
  bool is_signed = true;          // matters for velocities alone: positions are taken modulo

  bool operator==(const Mapping&) const = default;
};

struct Config {
  Mapping left = {.cob_id = 0x181};
  Mapping right = {.cob_id = 0x182};
  WheelQuantity quantity = WheelQuantity::kPosition;  // 0x6064; velocity: 0x606C
  double units_per_turn = 4096.0;
};

// Puts a value into the PDO and sets its identifier; the frame grows as needed.
void encode_mapped(CanFrame& frame, const Mapping& mapping, std::int32_t value);

struct Codec {
  Config config;

  WheelNews read(const CanFrame& frame) const;
  WheelScales scales(const WheelGeometry& geometry) const;
  CanIds ids() const;
};

}  // namespace zenith::canopen
