#pragma once
// One signal of a CAN frame, as DBC files describe it: plain data, read without heap.
//
//   raw        `bit_length` bits. Bit p of a frame is bit p % 8 (0 the least significant) of byte
//              p / 8. Intel order (@1): `start_bit` is the least significant bit of the signal, the
//              others follow at rising p. Motorola order (@0): `start_bit` is its most significant
//              bit, the others follow towards bit 0 of the byte, then from bit 7 of the next byte.
//   physical = scale * (raw as unsigned, two's complement, float32 or float64) + offset

#include <cstdint>

#include "drivers/odometry/can_frame.h"
#include "platform/base/fixed_vector.h"

namespace zenith {

enum class DbcValue { kUnsigned, kSigned, kFloat32, kFloat64 };

struct DbcSignal {
  CanId id = {};
  std::uint32_t start_bit = 0;
  std::uint32_t bit_length = 8;  // 1..64
  bool motorola = false;
  DbcValue value = DbcValue::kUnsigned;
  double scale = 1.0;
  double offset = 0.0;

  bool operator==(const DbcSignal&) const = default;
};

// A multiplexed signal is in a frame when the selector's raw value is in one of these ranges, for
// each of its conditions: a selector may itself be multiplexed.
struct DbcRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;

  bool operator==(const DbcRange&) const = default;
};
inline constexpr std::size_t kMaxDbcRanges = 16;
struct DbcCondition {
  DbcSignal selector;
  FixedVector<DbcRange, kMaxDbcRanges> ranges;
};
using DbcConditions = FixedVector<DbcCondition, 3>;

// The frame is long enough for all selectors.
bool holds(const DbcConditions& conditions, const CanFrame& frame);
// Of the signal and its selectors.
std::uint32_t bytes_needed(const DbcSignal& signal, const DbcConditions& conditions);

// How many bytes a frame must have to hold the signal; more than 8 when it does not fit any.
std::uint32_t bytes_needed(const DbcSignal& signal);

// The frame is long enough (bytes_needed); its identifier is not looked at.
std::uint64_t read_raw(const DbcSignal& signal, const CanFrame& frame);
void write_raw(const DbcSignal& signal, std::uint64_t raw, CanFrame& frame);

double physical_of(const DbcSignal& signal, std::uint64_t raw);
// The nearest raw value; saturates at the ends of what the signal holds.
std::uint64_t raw_of(const DbcSignal& signal, double physical);

// Puts a physical value into the frame and sets its identifier; the frame grows as needed.
void encode_signal(const DbcSignal& signal, double physical, CanFrame& frame);

}  // namespace zenith
