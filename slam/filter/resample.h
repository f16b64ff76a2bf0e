#pragma once
// Systematic resampling (Kitagawa 1996): one random number, n equally spaced pointers into the
// cumulated weights. Survivors keep their order, so parents[] never falls.

#include <cstdint>
#include <span>

namespace zenith {

// `weight` sums to 1; `uniform` in [0, 1). parents[i]: whom the new particle i continues.
void systematic_resample(std::span<const double> weight, double uniform,
                         std::span<std::uint16_t> parents);

}  // namespace zenith
