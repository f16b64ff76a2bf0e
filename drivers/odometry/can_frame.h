#pragma once
// A classic CAN frame with its capture stamp, as plain data.

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>

#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"

namespace zenith {

struct CanId {
  std::uint32_t id = 0;   // 11 or 29 bits, without flags
  bool extended = false;  // 29-bit identifier

  auto operator<=>(const CanId&) const = default;
};

// The identifiers that somebody reads.
using CanIds = FixedVector<CanId, 4>;

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

// Whether a filter lets the frame through; an empty one lets all through.
inline bool passes(const CanFrame& frame, const CanIds& ids) {
  return ids.empty() || std::find(ids.begin(), ids.end(), id_of(frame)) != ids.end();
}

}  // namespace zenith
