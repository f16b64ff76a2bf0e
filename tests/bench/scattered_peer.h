#pragma once
// A peer's map for benchmarks: real looks from rendered frames, scattered over 500 m2, all at about
// the same height.

#include <cstdint>
#include <vector>

#include "platform/base/random.h"
#include "slam/fleet/record.h"
#include "slam/image/feature.h"

namespace zenith::bench {

class ScatteredPeer {
 public:
  static constexpr int kLooks = 4;  // of each landmark

  explicit ScatteredPeer(std::uint64_t seed);

  // Landmark `index` lies where its number and the random numbers so far put it.
  LandmarkRecord record(std::uint32_t index);
  // What landmark `index` looks like first.
  const Feature& look(std::uint32_t index) const { return looks_[index * 7 % looks_.size()]; }

 private:
  Random random_;
  std::vector<Feature> looks_;
};

}  // namespace zenith::bench
