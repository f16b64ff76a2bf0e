// Under a ceiling that repeats itself two motions look alike; what is expected decides between
// them, and between nothing else.

#include "slam/watch/visual_motion.h"

#include <gtest/gtest.h>

#include "tests/support/point_world.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr double kPeriod = 0.45;  // tangents

// Rows of three corners, alike or each of its own look, seen after the picture moved.
std::vector<Feature> tiles(std::uint64_t seed, bool alike, double moved) {
  Random random(seed);
  std::vector<Feature> features;
  for (int k = -5; k <= 5; ++k) {
    Patch patch = point_world::random_patch(random);
    for (int i = -1; i <= 1; ++i) {
      if (!alike) patch = point_world::random_patch(random);
      if (moved > 0.0 && i == 1) continue;  // out of view by now
      Feature f;
      f.zx = static_cast<float>(kPeriod * i + moved);
      f.zy = static_cast<float>(0.12 * k);
      f.described = true;
      f.patch = patch;
      f.compact = compact(patch);
      features.push_back(f);
    }
  }
  return features;
}

VisualMotion motion_of(std::uint64_t seed, bool alike, double moved,
                       std::optional<Eigen::Vector2d> expected) {
  KeptCorners before;
  keep_corners(tiles(seed, alike, 0.0), before);
  return visual_motion(before, tiles(seed, alike, moved), expected);
}

TEST(VisualMotion, WhatIsExpectedDecidesBetweenAlikeMotions) {
  const TestSeed seed;
  const VisualMotion small = motion_of(seed.value(), true, 0.25, {});
  ASSERT_TRUE(small.known);
  EXPECT_NEAR(small.shift.x(), 0.2, 0.01);  // a tile back is nearer
  const VisualMotion right = motion_of(seed.value(), true, 0.25, Eigen::Vector2d(-0.27, 0.0));
  ASSERT_TRUE(right.known);
  EXPECT_NEAR(right.shift.x(), -0.25, 0.01);
}

TEST(VisualMotion, WhatIsSeenClearlyIsNotWhatIsExpected) {
  const TestSeed seed;
  for (const double expected : {-0.2, 0.1, 0.0, 0.5}) {
    const VisualMotion seen = motion_of(seed.value(), false, 0.2, Eigen::Vector2d(expected, 0.0));
    ASSERT_TRUE(seen.known);
    EXPECT_NEAR(seen.shift.x(), -0.2, 0.01) << expected;
  }
}

}  // namespace
}  // namespace zenith
