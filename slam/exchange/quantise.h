#pragma once
// Numbers as the protocol rounds them (docs/protocol.md, "Payload"). All decoded values are finite.

#include <array>
#include <cstdint>

#include "slam/capacity.h"

namespace zenith::exchange {

// Metres as whole millimetres, signed 24 bits; false beyond +-8388.607 m or when not finite.
bool encode_place(float metres, std::int32_t& mm);
inline constexpr std::int32_t kMaxPlace_mm = 0x7FFFFF;
inline float decode_mm(std::int32_t mm) {
  return static_cast<float>(static_cast<double>(mm) * 1e-3);
}
// Signed 32 bits; what lies beyond stops at the end, and what is no number is 0.
std::int32_t clamp_mm(double metres);

// A standard deviation as one byte k: 1e-4 * 2^(k / 16) metres (or radians).
double decode_deviation(std::uint8_t k);
float decode_variance(std::uint8_t k);
// The smallest k whose decoded variance is at least this one; false when none is, or when it is
// negative or no number.
bool encode_variance(float variance, std::uint8_t& k);
// Stops at 255, which is also what no number becomes.
std::uint8_t clamp_deviation(double deviation);

// Angles as parts of a turn. What is no number is 0. Decoded into [-pi, pi).
std::uint8_t encode_turn8(double angle_rad);
std::uint16_t encode_turn16(double angle_rad);
float decode_turn8(std::uint8_t parts);
double decode_turn16(std::uint16_t parts);

// Correlations xy, xz, yz in 1 / 127.
using Correlations = std::array<std::int8_t, 3>;
inline constexpr int kCorrelationUnit = 127;
// Exact: a matrix with these correlations is positive semidefinite. False with -128.
bool semidefinite(const Correlations& correlations);
// Of the covariance xx xy xz yy yz zz: rounded towards zero, then shrunk until semidefinite().
Correlations encode_correlations(const std::array<float, 6>& covariance);
std::array<float, 6> decode_covariance(const std::array<std::uint8_t, 3>& deviations,
                                       const Correlations& correlations);

// 32 coefficients of 5 bits: -15 .. 15, the largest of a look 15 or -15; code c stands for the
// value (14 c^2 + 12) / 25 with its sign, whole numbers. Coefficient i lies in the bits 5 i .. 5 i
// + 4, bit 0 being the lowest of the first byte. docs/measurements/descriptors.md says why so.
inline constexpr std::size_t kBitsOfCoefficient = 5;
inline constexpr std::size_t kLookBytes = kCompactLength * kBitsOfCoefficient / 8;
inline constexpr int kLargestCode = 15;
inline constexpr int kLargestValue = 126;
using Coefficients = std::array<std::int8_t, kCompactLength>;
std::array<std::uint8_t, kLookBytes> encode_coefficients(const Coefficients& values);
// False when a code is -16.
bool decode_coefficients(const std::uint8_t* bytes, Coefficients& values);

}  // namespace zenith::exchange
