#include "slam/exchange/quantise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace zenith::exchange {
namespace {

constexpr double kSmallestDeviation = 1e-4;
constexpr int kLookUnit = 7;
constexpr int kLookStep = 18;

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
    const double correlation = std::clamp(xy / norm, -1.0, 1.0);
    return static_cast<std::int8_t>(std::trunc(kCorrelationUnit * correlation));
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
  const auto nibble = [largest](std::int8_t value) {
    const double scaled = std::round(static_cast<double>(value) * kLookUnit / largest);
    return static_cast<unsigned>(static_cast<int>(scaled)) & 0xFU;
  };
  std::array<std::uint8_t, kLookBytes> bytes = {};
  for (std::size_t i = 0; i < kLookBytes; ++i) {
    bytes[i] = static_cast<std::uint8_t>(nibble(values[2 * i]) | nibble(values[2 * i + 1]) << 4u);
  }
  return bytes;
}

bool decode_coefficients(const std::uint8_t* bytes, Coefficients& values) {
  const auto coefficient = [](unsigned nibble) {
    const int value = static_cast<int>(nibble) - (nibble >= 8 ? 16 : 0);
    return value;
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int value = coefficient((bytes[i / 2] >> (4u * (i % 2))) & 0xFU);
    if (value < -kLookUnit) return false;
    values[i] = static_cast<std::int8_t>(value * kLookStep);
  }
  return true;
}

}  // namespace zenith::exchange
