#include "slam/exchange/quantise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace zenith::exchange {
namespace {

constexpr double kSmallestDeviation = 1e-4;

// 2^(i / 16): written out, so that all machines decode the same.
constexpr std::array<double, 16> kSixteenths = {
    1.0,
    1.0442737824274138,
    1.0905077326652577,
    1.1387886347566916,
    1.1892071150027210,
    1.2418578120734840,
    1.2968395546510096,
    1.3542555469368927,
    1.4142135623730951,
    1.4768261459394993,
    1.5422108254079408,
    1.6104903319492543,
    1.6817928305074290,
    1.7562521603732995,
    1.8340080864093424,
    1.9152065613971474,
};

double parts_of_turn(double angle_rad, double parts) {
  if (!std::isfinite(angle_rad)) return 0.0;
  const double turns = std::remainder(angle_rad, 2.0 * std::numbers::pi) / (2.0 * std::numbers::pi);
  return std::round(turns * parts);
}

// Small coefficients are as many as they are telling: they get the finer steps.
int value_of(int code) {
  const int magnitude = (14 * code * code + 12) / 25;
  return code < 0 ? -magnitude : magnitude;
}

int nearest_code(double value) {
  int best = 0;
  for (int code = 1; code <= kLargestCode; ++code) {
    if (std::abs(value_of(code) - std::abs(value)) < std::abs(value_of(best) - std::abs(value))) {
      best = code;
    }
  }
  return value < 0.0 ? -best : best;
}

}  // namespace

bool encode_place(float metres, std::int32_t& mm) {
  const double rounded = std::round(static_cast<double>(metres) * 1e3);
  if (!(std::abs(rounded) <= kMaxPlace_mm)) return false;
  mm = static_cast<std::int32_t>(rounded);
  return true;
}

std::int32_t clamp_mm(double metres) {
  if (std::isnan(metres)) return 0;
  return static_cast<std::int32_t>(
      std::clamp(std::round(metres * 1e3), -2147483648.0, 2147483647.0));
}

double decode_deviation(std::uint8_t k) {
  return kSmallestDeviation * std::ldexp(kSixteenths[k % 16u], k / 16);
}

float decode_variance(std::uint8_t k) {
  const double deviation = decode_deviation(k);
  return static_cast<float>(deviation * deviation);
}

bool encode_variance(float variance, std::uint8_t& k) {
  if (!(variance >= 0.0F) || variance > decode_variance(255)) return false;
  k = clamp_deviation(std::sqrt(static_cast<double>(variance)));
  while (decode_variance(k) < variance) ++k;
  while (k > 0 && decode_variance(static_cast<std::uint8_t>(k - 1)) >= variance) --k;
  return true;
}

std::uint8_t clamp_deviation(double deviation) {
  if (std::isnan(deviation)) return 255;
  if (deviation <= kSmallestDeviation) return 0;
  // A hair less than what was decoded is still the same byte.
  const double k = std::ceil(16.0 * std::log2(deviation / kSmallestDeviation) - 1e-9);
  return static_cast<std::uint8_t>(std::clamp(k, 0.0, 255.0));
}

std::uint8_t encode_turn8(double angle_rad) {
  return static_cast<std::uint8_t>(static_cast<int>(parts_of_turn(angle_rad, 256.0)));
}

std::uint16_t encode_turn16(double angle_rad) {
  return static_cast<std::uint16_t>(static_cast<int>(parts_of_turn(angle_rad, 65536.0)));
}

float decode_turn8(std::uint8_t parts) {
  return static_cast<float>(static_cast<std::int8_t>(parts) * (std::numbers::pi / 128.0));
}

double decode_turn16(std::uint16_t parts) {
  return static_cast<std::int16_t>(parts) * (std::numbers::pi / 32768.0);
}

bool semidefinite(const Correlations& correlations) {
  // All principal minors of the matrix with ones on its diagonal, times powers of 127.
  const int a = correlations[0];
  const int b = correlations[1];
  const int c = correlations[2];
  constexpr int kOne = kCorrelationUnit;
  if (std::min({a, b, c}) < -kOne) return false;
  return kOne * kOne * kOne + 2 * a * b * c - kOne * (a * a + b * b + c * c) >= 0;
}

Correlations encode_correlations(const std::array<float, 6>& covariance) {
  const auto encode = [](double xy, double xx, double yy) {
    const double norm = std::sqrt(xx) * std::sqrt(yy);
    if (!(norm > 0.0)) return std::int8_t{0};
    const double parts = kCorrelationUnit * std::clamp(xy / norm, -1.0, 1.0);
    // What was decoded is a whole number but for the rounding of floats, and stays what it is.
    constexpr double kRounding = 1e-4;
    return static_cast<std::int8_t>(std::trunc(parts + std::copysign(kRounding, parts)));
  };
  Correlations r = {encode(covariance[1], covariance[0], covariance[3]),
                    encode(covariance[2], covariance[0], covariance[5]),
                    encode(covariance[4], covariance[3], covariance[5])};
  while (!semidefinite(r)) {
    for (std::int8_t& c : r) c = static_cast<std::int8_t>(c * 31 / 32);
  }
  return r;
}

std::array<float, 6> decode_covariance(const std::array<std::uint8_t, 3>& deviations,
                                       const Correlations& correlations) {
  const double x = decode_deviation(deviations[0]);
  const double y = decode_deviation(deviations[1]);
  const double z = decode_deviation(deviations[2]);
  const auto product = [](double a, double b, int correlation) {
    return static_cast<float>(a * b * correlation / kCorrelationUnit);
  };
  return {decode_variance(deviations[0]), product(x, y, correlations[0]),
          product(x, z, correlations[1]), decode_variance(deviations[1]),
          product(y, z, correlations[2]), decode_variance(deviations[2])};
}

std::array<std::uint8_t, kLookBytes> encode_coefficients(const Coefficients& values) {
  int largest = 1;
  for (const std::int8_t value : values) largest = std::max(largest, std::abs(int{value}));
  std::array<std::uint8_t, kLookBytes> bytes = {};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double scaled = static_cast<double>(values[i]) * kLargestValue / largest;
    const unsigned code = static_cast<unsigned>(nearest_code(scaled)) & 0x1FU;
    const std::size_t bit = i * kBitsOfCoefficient;
    const unsigned placed = code << (bit % 8);
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] | (placed & 0xFFU));
    if (placed > 0xFFU) bytes[bit / 8 + 1] = static_cast<std::uint8_t>(placed >> 8U);
  }
  return bytes;
}

bool decode_coefficients(const std::uint8_t* bytes, Coefficients& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t bit = i * kBitsOfCoefficient;
    unsigned window = bytes[bit / 8];
    if (bit / 8 + 1 < kLookBytes) window |= static_cast<unsigned>(bytes[bit / 8 + 1]) << 8U;
    const unsigned field = (window >> (bit % 8)) & 0x1FU;
    const int code = static_cast<int>(field) - (field >= 16 ? 32 : 0);
    if (code < -kLargestCode) return false;
    values[i] = static_cast<std::int8_t>(value_of(code));
  }
  return true;
}

}  // namespace zenith::exchange
