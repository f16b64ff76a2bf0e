#pragma once
// VESC's cyclic status frames, byte for byte. Each wheel has its own controller; 29-bit identifiers
// are packet << 8 | controller.
//
//   0x09 status 1  int32 ERPM (electrical turns/min), int16 current x 10, int16 duty x 1000
//   0x1B status 5  int32 tachometer (counts), int16 input voltage x 10 (newer: int16 reserved)
//
// All integers are big-endian. The tachometer counts commutation steps: six for each electrical
// turn, so 6 x pole pairs in one turn of the motor; calibrate it, for firmware differs. It wraps at
// 32 bits and restarts at zero with the controller.
// Source: the VESC firmware's CAN documentation. Status 5 must be switched on in its settings.

#include <cstdint>
#include <optional>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec.h"

namespace zenith::vesc {

inline constexpr std::uint32_t kMaxController = 0xFF;

struct Config {
  std::uint32_t left_id = 0;
  std::uint32_t right_id = 1;
  WheelQuantity quantity = WheelQuantity::kPosition;  // status 5; velocity: status 1
  double counts_per_turn = 42.0;                      // tachometer, per turn of the motor
  double pole_pairs = 7.0;                            // for ERPM
};

struct Status1 {
  std::int32_t erpm = 0;
  double current_a = 0.0;
  double duty = 0.0;
};

struct Status5 {
  std::int32_t tachometer = 0;
  double input_voltage_v = 0.0;
};

// Empty when the frame has another identifier or too few bytes.
std::optional<Status1> decode_status1(const CanFrame& frame, std::uint32_t controller);
std::optional<Status5> decode_status5(const CanFrame& frame, std::uint32_t controller);

// Round, and saturate at the ends of int16.
CanFrame encode_status1(Time stamp, std::uint32_t controller, const Status1& status);
CanFrame encode_status5(Time stamp, std::uint32_t controller, const Status5& status);

struct Codec {
  Config config;

  WheelNews read(const CanFrame& frame) const;
  WheelScales scales(const WheelGeometry& geometry) const;
  CanIds ids() const;
};

}  // namespace zenith::vesc
