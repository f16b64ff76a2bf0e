#pragma once
// The log format of `candump -L`:   (seconds.microseconds) interface ID#DATA
//
//   (1436509052.249713) can0 311#0000002A0000002B      11-bit identifier: three digits
//   (1436509052.249713) can0 0000091B#00112233         29-bit identifier: eight digits
//   123#R, 123#R4   remote frame;   123##1AABB   CAN FD;   20000004#...   error frame

#include <string>
#include <string_view>

#include "drivers/odometry/can_frame.h"

namespace zenith {

enum class CandumpLine {
  kFrame,  // a classic data frame: `frame` and `interface` are filled
  kOther,  // well formed, but remote, FD or an error frame; or an empty line
  kMalformed,
};

// `interface` views into `line`.
CandumpLine parse_candump(std::string_view line, CanFrame& frame, std::string_view& interface);

// Without the newline.
std::string format_candump(const CanFrame& frame, std::string_view interface);

}  // namespace zenith
