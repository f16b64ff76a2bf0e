#pragma once
// Random numbers that are the same on every machine and library: PCG32 (O'Neill 2014, XSH-RR)
// with our own uniform and normal. <random>'s distributions differ between standard libraries.

#include <cmath>
#include <cstdint>

namespace zenith {

class Random {
 public:
  // Different streams are independent sequences from the same seed.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : increment_((stream << 1u) | 1u) {
    next_u32();
    state_ += seed;
    next_u32();
  }

  std::uint32_t next_u32() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    const auto rot = static_cast<std::uint32_t>(old >> 59u);
    return (xorshifted >> rot) | (xorshifted << ((32u - rot) & 31u));
  }

  // In [0, 1), 32 bits of resolution.
  double uniform() { return next_u32() * (1.0 / 4294967296.0); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // In [0, n); the bias of about n / 2^32 does not matter here.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((std::uint64_t{next_u32()} * n) >> 32u);
  }

  // Standard normal, by Box and Muller's polar method.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = 2.0 * uniform() - 1.0;
      v = 2.0 * uniform() - 1.0;
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace zenith
