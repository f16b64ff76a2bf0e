#pragma once
// Integers and floats in a frame's bytes, in both byte orders. The caller has checked that the
// frame is long enough; beyond 8 bytes is a programmer's mistake.

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "drivers/odometry/can_frame.h"

namespace zenith {

inline std::uint32_t read_big_endian(const CanFrame& frame, std::size_t at, std::size_t bytes) {
  assert(bytes <= 4 && at + bytes <= frame.data.size());
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value = value << 8u | frame.data[at + i];
  return value;
}

inline std::uint32_t read_little_endian(const CanFrame& frame, std::size_t at, std::size_t bytes) {
  assert(bytes <= 4 && at + bytes <= frame.data.size());
  std::uint32_t value = 0;
  for (std::size_t i = bytes; i > 0; --i) value = value << 8u | frame.data[at + i - 1];
  return value;
}

inline void write_big_endian(CanFrame& frame, std::size_t at, std::size_t bytes,
                             std::uint32_t value) {
  assert(bytes <= 4 && at + bytes <= frame.data.size());
  for (std::size_t i = bytes; i > 0; --i, value >>= 8u) {
    frame.data[at + i - 1] = static_cast<std::uint8_t>(value);
  }
}

// A big-endian int16 in steps of `unit`.
inline double read_big_endian_i16(const CanFrame& frame, std::size_t at, double unit) {
  return unit * static_cast<std::int16_t>(read_big_endian(frame, at, 2));
}

// Rounds, and saturates at the ends of int16.
inline void write_big_endian_i16(CanFrame& frame, std::size_t at, double unit, double value) {
  const double steps = std::clamp(std::round(value / unit), -32768.0, 32767.0);
  write_big_endian(frame, at, 2, static_cast<std::uint32_t>(static_cast<std::int32_t>(steps)));
}

inline void write_little_endian(CanFrame& frame, std::size_t at, std::size_t bytes,
                                std::uint32_t value) {
  assert(bytes <= 4 && at + bytes <= frame.data.size());
  for (std::size_t i = 0; i < bytes; ++i, value >>= 8u) {
    frame.data[at + i] = static_cast<std::uint8_t>(value);
  }
}

inline float read_little_endian_float(const CanFrame& frame, std::size_t at) {
  return std::bit_cast<float>(read_little_endian(frame, at, 4));
}

inline void write_little_endian_float(CanFrame& frame, std::size_t at, float value) {
  write_little_endian(frame, at, 4, std::bit_cast<std::uint32_t>(value));
}

}  // namespace zenith
