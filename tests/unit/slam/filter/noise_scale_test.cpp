#include "slam/filter/noise_scale.h"

#include <array>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

struct Corners {
  double sigma = 1.0;        // in stated ones
  double memory = 0.0;       // from frame to frame
  double wrong_share = 0.0;  // matches that are wrong
};

// So many frames of 60 landmarks.
void show(NoiseScale& scale, const Corners& corners, int frames, Random& random) {
  constexpr int kLandmarks = 60;
  const double fresh = std::sqrt(1.0 - corners.memory * corners.memory);
  std::array<std::array<double, 2>, kLandmarks> error = {};
  std::array<std::array<double, 2>, kLandmarks> last = {};
  for (auto& e : error) e = {random.normal(), random.normal()};
  for (int frame = 0; frame < frames; ++frame) {
    for (int k = 0; k < kLandmarks; ++k) {
      auto& e = error[static_cast<std::size_t>(k)];
      for (double& component : e) {
        component = corners.memory * component + fresh * random.normal();
      }
      const bool wrong = random.uniform() < corners.wrong_share;
      const double size = wrong ? 20.0 : corners.sigma;
      const std::array<double, 2> seen = {size * e[0], size * e[1]};
      scale.add((seen[0] * seen[0] + seen[1] * seen[1]) / scale.kappa_1());
      auto& before = last[static_cast<std::size_t>(k)];
      if (frame > 0) {
        scale.add_pair(seen[0], before[0]);
        scale.add_pair(seen[1], before[1]);
      }
      before = seen;
    }
    scale.end_frame();
  }
}

TEST(NoiseScale, FindsHowNoisyCornersAre) {
  const TestSeed seed;
  Random random(seed.value());
  for (const double sigma : {1.0, 1.5, 3.0, 6.0}) {
    NoiseScale scale;
    show(scale, {sigma, 0.0, 0.0}, 80, random);
    EXPECT_NEAR(scale.sigma_factor(), sigma, 0.2 * sigma) << sigma;
    EXPECT_TRUE(scale.settled());
  }
}

TEST(NoiseScale, WrongMatchesHardlyMatter) {
  const TestSeed seed;
  Random random(seed.value());
  NoiseScale scale;
  show(scale, {2.0, 0.0, 0.15}, 80, random);
  EXPECT_NEAR(scale.sigma_factor(), 2.0, 0.6);
}

// (1 + 0.6) / (1 - 0.6) = 4 times the variance.
TEST(NoiseScale, ErrorsThatLastCountAsLargerOnes) {
  const TestSeed seed;
  Random random(seed.value());
  NoiseScale scale;
  show(scale, {1.5, 0.6, 0.0}, 200, random);
  EXPECT_NEAR(scale.memory(), 0.6, 0.1);
  EXPECT_NEAR(scale.sigma_factor(), 3.0, 0.6);
}

TEST(NoiseScale, StaysWithinItsBounds) {
  const TestSeed seed;
  Random random(seed.value());
  NoiseScale quiet;
  show(quiet, {0.05, 0.0, 0.0}, 300, random);
  EXPECT_EQ(quiet.kappa(), 1.0);
  NoiseScale loud;
  show(loud, {50.0, 0.8, 0.0}, 300, random);
  EXPECT_EQ(loud.sigma_factor(), NoiseScale::kMostNoise);
}

TEST(NoiseScale, FollowsWhatChangesLater) {
  const TestSeed seed;
  Random random(seed.value());
  NoiseScale scale;
  show(scale, {1.0, 0.0, 0.0}, 300, random);
  show(scale, {4.0, 0.0, 0.0}, 300, random);
  EXPECT_NEAR(scale.sigma_factor(), 4.0, 0.8);
  show(scale, {1.0, 0.0, 0.0}, 300, random);
  EXPECT_NEAR(scale.sigma_factor(), 1.0, 0.2);
}

TEST(NoiseScale, FramesWithFewMatchesTellNothing) {
  NoiseScale scale;
  for (int frame = 0; frame < 100; ++frame) {
    for (int k = 0; k < 5; ++k) scale.add(1000.0);
    EXPECT_FALSE(scale.end_frame());
  }
  EXPECT_EQ(scale.kappa(), 1.0);
  EXPECT_FALSE(scale.settled());
}

}  // namespace
}  // namespace zenith
