#pragma once
// Frames written as their bytes, for test vectors.

#include <algorithm>
#include <cstdint>
#include <initializer_list>

#include "drivers/odometry/can_frame.h"

namespace zenith {

inline CanFrame frame_of(CanId id, std::initializer_list<std::uint8_t> bytes,
                         std::int64_t stamp_ms = 0) {
  CanFrame frame;
  frame.stamp = Time{stamp_ms * 1'000'000};
  frame.id = id.id;
  frame.extended = id.extended;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

inline Time at_ms(std::int64_t ms) {
  return Time{ms * 1'000'000};
}

}  // namespace zenith
