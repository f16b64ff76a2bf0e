#pragma once
// The checksum of a map: the sum of mix(id, revision) over its landmarks, in any order.

#include <cstdint>

namespace zenith::exchange {

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014) over id * 2^32 + revision.
inline std::uint64_t mix(std::uint32_t id, std::uint32_t revision) {
  std::uint64_t z = std::uint64_t{id} << 32u | revision;
  z = (z ^ (z >> 30u)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27u)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31u);
}

}  // namespace zenith::exchange
