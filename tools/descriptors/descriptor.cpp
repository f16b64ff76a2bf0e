#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/exchange/quantise.h"
#include "slam/image/ncc.h"
#include "tools/descriptors/comparison.h"

namespace zenith::tools {
namespace {

using Basis = std::array<std::array<double, kPatchSize>, kPatchSize>;

Basis dct_basis() {
  Basis basis;
  for (std::size_t k = 0; k < kPatchSize; ++k) {
    const double norm = std::sqrt((k == 0 ? 1.0 : 2.0) / kPatchSize);
    for (std::size_t i = 0; i < kPatchSize; ++i) {
      const double phase = std::numbers::pi * (static_cast<double>(i) + 0.5) / kPatchSize;
      basis[k][i] = norm * std::cos(phase * static_cast<double>(k));
    }
  }
  return basis;
}

// Coefficient (fu, fv) of the patch.
double coefficient(const Patch& patch, std::size_t fu, std::size_t fv) {
  static const Basis kBasis = dct_basis();
  double sum = 0.0;
  for (std::size_t y = 0; y < kPatchSize; ++y) {
    double row = 0.0;
    for (std::size_t x = 0; x < kPatchSize; ++x) {
      row += kBasis[fu][x] * static_cast<double>(patch.values[y * kPatchSize + x]);
    }
    sum += kBasis[fv][y] * row;
  }
  return sum;
}

// In the order of compact(): rising sum of the two frequencies.
std::vector<double> zigzag(const Patch& patch, int length) {
  std::vector<double> out;
  for (int sum = 1; static_cast<int>(out.size()) < length; ++sum) {
    for (int k = 0; k <= sum && static_cast<int>(out.size()) < length; ++k) {
      const int fu = sum % 2 == 0 ? k : sum - k;
      out.push_back(
          coefficient(patch, static_cast<std::size_t>(fu), static_cast<std::size_t>(sum - fu)));
    }
  }
  return out;
}

Descriptor quantise(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double x : values) largest = std::max(largest, std::abs(x));
  Descriptor out;
  int energy = 0;
  for (const double x : values) {
    const auto q = static_cast<int>(std::lround(largest > 0.0 ? 127.0 * x / largest : 0.0));
    out.values.push_back(static_cast<std::int8_t>(q));
    energy += q * q;
  }
  if (energy > 0) out.inverse_norm = 1.0F / std::sqrt(static_cast<float>(energy));
  return out;
}

}  // namespace

Descriptor describe(const Patch& patch, int length) {
  if (length == kFullLength) {
    return {{patch.values.begin(), patch.values.end()}, patch.inverse_norm};
  }
  if (length == kCompactLength) {
    const CompactPatch c = compact(patch);
    return {{c.values.begin(), c.values.end()}, c.inverse_norm};
  }
  return quantise(zigzag(patch, length));
}

Descriptor sent(const Descriptor& descriptor) {
  exchange::Coefficients values = {};
  std::copy_n(descriptor.values.begin(), values.size(), values.begin());
  const auto bytes = exchange::encode_coefficients(values);
  exchange::decode_coefficients(bytes.data(), values);
  return {{values.begin(), values.end()}, compact_from(values).inverse_norm};
}

float similarity(const Descriptor& a, const Descriptor& b) {
  int dot = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) dot += int{a.values[i]} * int{b.values[i]};
  return static_cast<float>(dot) * a.inverse_norm * b.inverse_norm;
}

}  // namespace zenith::tools
