#pragma once
// One seed, many independent streams: each model draws from a stream of its own, named by a tag and
// an index, so that a change in one model does not move the numbers of another.

#include <cstdint>
#include <string_view>

#include "platform/base/random.h"

namespace zenith::sim {

// SplitMix64's finaliser (Steele, Lea, Flood 2014).
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30u)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27u)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31u);
}

inline std::uint64_t mix_seed(std::uint64_t seed, std::string_view tag, std::uint64_t index = 0) {
  std::uint64_t hash = mix_bits(seed);
  for (const char c : tag) hash = mix_bits(hash ^ static_cast<unsigned char>(c));
  return mix_bits(hash ^ index);
}

inline Random random_stream(std::uint64_t seed, std::string_view tag, std::uint64_t index = 0) {
  return Random(mix_seed(seed, tag, index), index);
}

}  // namespace zenith::sim
