#pragma once
// What every codec of a CAN base offers. A codec knows a layout and nothing else: it turns one
// frame into readings of one or both wheels, in the base's own units. What those readings mean over
// time (wraps, restarts, loss, pairing) is the WheelDecoder's business.
//
// A codec is plain data with three members; reading neither allocates nor locks:
//
//   WheelNews read(const CanFrame& frame) const;
//   WheelScales scales(const WheelGeometry& geometry) const;
//   CanIds ids() const;      the identifiers that it reads, for the kernel's filter

#include <cstdint>
#include <numbers>
#include <optional>

#include "drivers/odometry/can_frame.h"

namespace zenith {

enum class WheelQuantity { kPosition, kVelocity };

// How readings of one wheel become travel.
enum class WheelKind {
  kCounter,   // an integer position that wraps at counter_bits
  kPosition,  // a position that does not wrap
  kVelocity,  // units per second
};

struct WheelScale {
  WheelKind kind = WheelKind::kCounter;
  int counter_bits = 32;         // 2..64
  double metres_per_unit = 1.0;  // negative when forward travel counts down
};

struct WheelScales {
  WheelScale left;
  WheelScale right;
};

struct WheelGeometry {
  double wheel_radius_m = 0.1;
  double gear_ratio = 1.0;  // turns of the motor (or encoder) in one turn of the wheel

  double metres_per_motor_turn() const {
    return 2.0 * std::numbers::pi * wheel_radius_m / gear_ratio;
  }
};

struct WheelReading {
  std::uint64_t count = 0;  // kCounter: the low counter_bits; signed counters in two's complement
  double value = 0.0;       // kPosition, kVelocity; may be anything, also not a number
};

enum class FrameUse {
  kUnknownId,  // not a frame of this base
  kTooShort,   // one of its identifiers, too few bytes
  kNoTravel,   // a frame of this base that says nothing about travel
  kReading,    // at least one wheel's reading
};

struct WheelNews {
  FrameUse use = FrameUse::kUnknownId;
  std::optional<WheelReading> left;
  std::optional<WheelReading> right;
  std::optional<std::uint32_t> left_error;  // what a drive reports about itself; 0 is none
  std::optional<std::uint32_t> right_error;
};

}  // namespace zenith
