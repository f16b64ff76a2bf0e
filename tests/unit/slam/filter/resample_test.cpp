#include "slam/filter/resample.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(SystematicResample, EqualWeightsKeepEverybody) {
  const std::vector<double> weight(8, 0.125);
  std::vector<std::uint16_t> parents(8);
  for (const double u : {0.0, 0.3, 0.999}) {
    systematic_resample(weight, u, parents);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(parents[i], i);
  }
}

TEST(SystematicResample, TheOnlyHeavyOneTakesAll) {
  for (const std::size_t heavy : {std::size_t{0}, std::size_t{3}, std::size_t{7}}) {
    std::vector<double> weight(8, 0.0);
    weight[heavy] = 1.0;
    std::vector<std::uint16_t> parents(8);
    for (const double u : {0.0, 0.5, 0.9999999}) {
      systematic_resample(weight, u, parents);
      for (const std::uint16_t p : parents) EXPECT_EQ(p, heavy) << u;
    }
  }
}

TEST(SystematicResample, PointersAreEquallySpaced) {
  const std::array<double, 4> weight = {0.1, 0.5, 0.15, 0.25};
  std::array<std::uint16_t, 4> parents = {};
  systematic_resample(weight, 0.0, parents);  // pointers at 0, 0.25, 0.5, 0.75
  EXPECT_EQ(parents, (std::array<std::uint16_t, 4>{0, 1, 1, 3}));
  systematic_resample(weight, 0.5, parents);  // at 0.125, 0.375, 0.625, 0.875
  EXPECT_EQ(parents, (std::array<std::uint16_t, 4>{1, 1, 2, 3}));
}

TEST(SystematicResample, RoundingFallsToTheLast) {
  const std::array<double, 3> weight = {0.3, 0.3, 0.3};  // sums to less than 1
  std::array<std::uint16_t, 3> parents = {};
  systematic_resample(weight, 0.99, parents);
  EXPECT_EQ(parents[2], 2);
}

}  // namespace
}  // namespace zenith
