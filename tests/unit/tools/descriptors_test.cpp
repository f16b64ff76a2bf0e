// The descriptors under comparison, and the comparison on looks whose outcome is known.

#include <cmath>

#include <gtest/gtest.h>

#include "slam/image/ncc.h"
#include "tests/support/point_world.h"
#include "tests/support/seeds.h"
#include "tools/descriptors/comparison.h"

namespace zenith::tools {
namespace {

TEST(Descriptors, ManyCoefficientsAreFullNcc) {
  const TestSeed seed;
  Random random(seed.value());
  for (int i = 0; i < 20; ++i) {
    const Patch a = point_world::random_patch(random);
    const Patch b = point_world::random_patch(random);
    const float full = ncc(a, b);
    EXPECT_FLOAT_EQ(similarity(describe(a, kFullLength), describe(b, kFullLength)), full);
    // The waves of random_patch() end below the 120th coefficient, but for what int8 rounds away.
    EXPECT_NEAR(similarity(describe(a, 120), describe(b, 120)), full, 0.05F);
  }
}

TEST(Descriptors, CompactIsOneOfTheSeries) {
  const TestSeed seed;
  Random random(seed.value());
  for (int i = 0; i < 20; ++i) {
    const Patch patch = point_world::random_patch(random);
    const Descriptor compact = describe(patch, kCompactLength);
    const Descriptor longer = describe(patch, kCompactLength + 1);
    float dot = 0.0F;
    for (std::size_t k = 0; k < compact.values.size(); ++k) {
      dot += static_cast<float>(compact.values[k]) * static_cast<float>(longer.values[k]);
    }
    EXPECT_GT(dot * compact.inverse_norm * longer.inverse_norm, 0.95F);
  }
}

// Two landmarks, each seen twice from places 1 m apart; the second look of landmark 1 is that of
// landmark 0.
LookSequence two_landmarks(Random& random, bool confused) {
  LookSequence sequence;
  sequence.places_m = {{0.0, 0.0, 2.5}, {1.0, 0.0, 2.5}};
  const Patch patches[] = {point_world::random_patch(random), point_world::random_patch(random)};
  for (int frame = 0; frame < 2; ++frame) {
    for (int landmark = 0; landmark < 2; ++landmark) {
      Look look;
      look.landmark = landmark;
      look.frame = frame;
      look.T_world_robot = {static_cast<double>(frame), 0.0, 0.0};
      look.patch = patches[confused && frame == 1 ? 0 : landmark];
      sequence.looks.push_back(look);
    }
  }
  return sequence;
}

TEST(Descriptors, CountsRightAndWrongPairs) {
  const TestSeed seed;
  Random random(seed.value());
  const auto clear = compare_descriptors(two_landmarks(random, false), {});
  ASSERT_EQ(clear.size(), 1u);
  EXPECT_EQ(clear[0].queries, 2);
  EXPECT_EQ(clear[0].landmarks, 2);
  for (const DescriptorScore& score : clear[0].scores) {
    EXPECT_EQ(score.rank1, 1.0) << score.kind.name;
    EXPECT_EQ(score.true_accept, 1.0) << score.kind.name;
    EXPECT_EQ(score.false_accept, 0.0) << score.kind.name;
  }
  const auto confused = compare_descriptors(two_landmarks(random, true), {});
  for (const DescriptorScore& score : confused[0].scores) {
    EXPECT_EQ(score.rank1, 0.5) << score.kind.name;
    EXPECT_EQ(score.true_accept, 0.5) << score.kind.name;
    EXPECT_EQ(score.false_accept, 0.5) << score.kind.name;
  }
}

TEST(Descriptors, LooksFromNearbyAreNoTest) {
  const TestSeed seed;
  Random random(seed.value());
  LookSequence sequence = two_landmarks(random, false);
  for (Look& look : sequence.looks) look.T_world_robot.x_m *= 0.4;
  EXPECT_EQ(compare_descriptors(sequence, {})[0].queries, 0);
}

TEST(Descriptors, RareLandmarksAreDropped) {
  const TestSeed seed;
  Random random(seed.value());
  LookSequence sequence = two_landmarks(random, false);
  sequence.looks.erase(sequence.looks.begin());
  drop_rare_landmarks(sequence, 2);
  EXPECT_EQ(sequence.places_m.size(), 1u);
  ASSERT_EQ(sequence.looks.size(), 2u);
  EXPECT_EQ(sequence.looks[0].landmark, 0);
}

}  // namespace
}  // namespace zenith::tools
