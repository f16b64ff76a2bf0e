#pragma once
// A classic CAN frame with its capture stamp, as plain data.

#include <array>
#include <cstdint>

#include "platform/base/time.h"

namespace zenith {

struct CanId {
  std::uint32_t id = 0;   // 11 or 29 bits, without flags
  bool extended = false;  // 29-bit identifier

  bool operator==(const CanId&) const = default;
};

struct CanFrame {
  Time stamp;
  std::uint32_t id = 0;     // 11 or 29 bits, without flags
  bool extended = false;    // 29-bit identifier
  std::uint8_t length = 0;  // 0..8
  std::array<std::uint8_t, 8> data = {};
};

inline CanId id_of(const CanFrame& frame) {
  return {frame.id, frame.extended};
}

}  // namespace zenith
