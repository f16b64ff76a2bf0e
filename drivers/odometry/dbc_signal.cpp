#include "drivers/odometry/dbc_signal.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace zenith {
namespace {

// From the most significant bit of a Motorola signal to the next one.
std::uint32_t next_motorola(std::uint32_t position) {
  return position % 8 == 0 ? position + 15 : position - 1;
}

std::uint64_t bit_at(const CanFrame& frame, std::uint32_t position) {
  return static_cast<std::uint64_t>(frame.data[position / 8] >> (position % 8)) & 1U;
}

void set_bit(CanFrame& frame, std::uint32_t position, bool on) {
  const auto mask = static_cast<std::uint8_t>(1U << (position % 8));
  std::uint8_t& byte = frame.data[position / 8];
  byte = static_cast<std::uint8_t>(on ? byte | mask : byte & ~mask);
}

std::int64_t sign_extend(std::uint64_t raw, std::uint32_t bits) {
  const std::uint32_t unused = 64 - bits;
  return static_cast<std::int64_t>(raw << unused) >> unused;
}

std::uint64_t clamp_integer(double steps, std::uint32_t bits, bool is_signed) {
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - bits);
  const double size = std::ldexp(1.0, static_cast<int>(bits));
  if (std::isnan(steps)) return 0;
  if (!is_signed) {
    if (steps <= 0.0) return 0;
    return steps >= size ? all : static_cast<std::uint64_t>(steps);
  }
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  if (steps >= 0.5 * size) return sign - 1;
  if (steps <= -0.5 * size) return sign;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(steps)) & all;
}

}  // namespace

std::uint32_t bytes_needed(const DbcSignal& signal) {
  if (!signal.motorola) return (signal.start_bit + signal.bit_length - 1) / 8 + 1;
  std::uint32_t position = signal.start_bit;
  for (std::uint32_t i = 1; i < signal.bit_length; ++i) position = next_motorola(position);
  return position / 8 + 1;
}

std::uint32_t bytes_needed(const DbcSignal& signal, const DbcConditions& conditions) {
  std::uint32_t bytes = bytes_needed(signal);
  for (const DbcCondition& condition : conditions) {
    bytes = std::max(bytes, bytes_needed(condition.selector));
  }
  return bytes;
}

bool holds(const DbcConditions& conditions, const CanFrame& frame) {
  return std::all_of(conditions.begin(), conditions.end(), [&](const DbcCondition& condition) {
    const std::uint64_t raw = read_raw(condition.selector, frame);
    return std::any_of(
        condition.ranges.begin(), condition.ranges.end(),
        [raw](const DbcRange& range) { return raw >= range.first && raw <= range.last; });
  });
}

std::uint64_t read_raw(const DbcSignal& signal, const CanFrame& frame) {
  assert(bytes_needed(signal) <= frame.data.size());
  std::uint64_t raw = 0;
  std::uint32_t position = signal.start_bit;
  for (std::uint32_t i = 0; i < signal.bit_length; ++i) {
    if (signal.motorola) {
      raw = raw << 1U | bit_at(frame, position);
      position = next_motorola(position);
    } else {
      raw |= bit_at(frame, position++) << i;
    }
  }
  return raw;
}

void write_raw(const DbcSignal& signal, std::uint64_t raw, CanFrame& frame) {
  assert(bytes_needed(signal) <= frame.data.size());
  std::uint32_t position = signal.start_bit;
  for (std::uint32_t i = 0; i < signal.bit_length; ++i) {
    if (signal.motorola) {
      set_bit(frame, position, (raw >> (signal.bit_length - 1 - i) & 1U) != 0);
      position = next_motorola(position);
    } else {
      set_bit(frame, position++, (raw >> i & 1U) != 0);
    }
  }
}

double physical_of(const DbcSignal& signal, std::uint64_t raw) {
  double value = 0.0;
  switch (signal.value) {
    case DbcValue::kUnsigned:
      value = static_cast<double>(raw);
      break;
    case DbcValue::kSigned:
      value = static_cast<double>(sign_extend(raw, signal.bit_length));
      break;
    case DbcValue::kFloat32:
      value = std::bit_cast<float>(static_cast<std::uint32_t>(raw));
      break;
    case DbcValue::kFloat64:
      value = std::bit_cast<double>(raw);
      break;
  }
  return signal.scale * value + signal.offset;
}

std::uint64_t raw_of(const DbcSignal& signal, double physical) {
  const double value = (physical - signal.offset) / signal.scale;
  switch (signal.value) {
    case DbcValue::kUnsigned:
    case DbcValue::kSigned:
      return clamp_integer(std::round(value), signal.bit_length, signal.value == DbcValue::kSigned);
    case DbcValue::kFloat32:
      return std::bit_cast<std::uint32_t>(static_cast<float>(value));
    case DbcValue::kFloat64:
      return std::bit_cast<std::uint64_t>(value);
  }
  return 0;
}

void encode_signal(const DbcSignal& signal, double physical, CanFrame& frame) {
  frame.id = signal.id.id;
  frame.extended = signal.id.extended;
  frame.length = std::max(frame.length, static_cast<std::uint8_t>(bytes_needed(signal)));
  write_raw(signal, raw_of(signal, physical), frame);
}

}  // namespace zenith
