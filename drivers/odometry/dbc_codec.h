#pragma once
// Any base whose wheels stand in a DBC file: one signal for each wheel, in one message or in two,
// as velocity or as position.
//
// Integer positions count modulo 2^length, so a wrap is a step; float positions do not wrap.
// `metres_per_unit` takes the signal's physical unit to metres or metres per second: 1/3.6 for
// km/h, 0.001 for mm, the wheel's circumference for turns.

#include <string>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/dbc_signal.h"
#include "drivers/odometry/wheel_codec.h"

namespace zenith::dbc {

struct Config {
  std::string file;
  std::string left_signal;  // SIGNAL, or MESSAGE.SIGNAL
  std::string right_signal;
  WheelQuantity quantity = WheelQuantity::kVelocity;
  double metres_per_unit = 1.0;
};

// Signals that find_signal() gave.
struct Codec {
  DbcSignal left;
  DbcSignal right;
  WheelQuantity quantity = WheelQuantity::kVelocity;
  double metres_per_unit = 1.0;
  DbcConditions left_when = {};  // multiplexed: the frames that hold the signal
  DbcConditions right_when = {};

  WheelNews read(const CanFrame& frame) const;
  WheelScales scales(const WheelGeometry& geometry) const;
  CanIds ids() const;
};

}  // namespace zenith::dbc
