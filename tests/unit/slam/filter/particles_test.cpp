#include "slam/filter/particles.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "slam/counters.h"
#include "tests/support/arena_block.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

struct Set {
  Particles particles;
  ArenaBlock block;
  explicit Set(int n) : block([this, n](Arena& arena) { particles.layout(arena, n); }) {}
};

TEST(Particles, WeightsAreNormalisedFromLogs) {
  Set set(4);
  Particles& p = set.particles;
  const double offset = -12345.0;  // common, and far below what exp() could take
  for (std::size_t i = 0; i < 4; ++i) {
    p.log_weight[i] = offset + std::log(static_cast<double>(i + 1));
  }
  RepairCounters repairs;
  const double effective = normalise_weights(p, repairs);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(p.weight[i], static_cast<double>(i + 1) / 10.0, 1e-9);
    sum += p.weight[i];
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(effective, 100.0 / 30.0, 1e-8);
  EXPECT_EQ(p.log_weight[3], 0.0);
}

TEST(Particles, EqualWeightsCountAllAndOneCountsOne) {
  Set set(50);
  RepairCounters repairs;
  for (double& w : set.particles.log_weight) w = -7.0;
  EXPECT_NEAR(normalise_weights(set.particles, repairs), 50.0, 1e-9);
  set.particles.log_weight[17] = 1e4;
  EXPECT_NEAR(normalise_weights(set.particles, repairs), 1.0, 1e-12);
  EXPECT_EQ(set.particles.weight[17], 1.0);
  EXPECT_EQ(repairs.total(), 0u);
}

// Whichever particle it is, also the first and the heaviest: the others keep their weights.
TEST(Particles, AWeightThatIsNoNumberIsNone) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinite, -kInfinite}) {
    for (const std::size_t i : {0u, 1u, 3u}) {
      Set set(4);
      Particles& p = set.particles;
      for (std::size_t k = 0; k < 4; ++k) p.log_weight[k] = -1e3;
      p.log_weight[i] = bad;
      RepairCounters repairs;
      EXPECT_NEAR(normalise_weights(p, repairs), 3.0, 1e-12);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(p.weight[k], k == i ? 0.0 : 1.0 / 3.0, 1e-12);
      EXPECT_EQ(repairs.weights_zeroed, bad == -kInfinite ? 0u : 1u);
      EXPECT_EQ(repairs.weights_equalised, 0u);
      EXPECT_NEAR(normalise_weights(p, repairs), 3.0, 1e-12) << "it stays so";
    }
  }
}

TEST(Particles, WithoutAnyWeightAllAreAlike) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    Set set(5);
    for (double& w : set.particles.log_weight) w = bad;
    RepairCounters repairs;
    EXPECT_NEAR(normalise_weights(set.particles, repairs), 5.0, 1e-12);
    EXPECT_NEAR(set.particles.weight[4], 0.2, 1e-12);
    EXPECT_EQ(repairs.weights_equalised, 1u);
  }
}

TEST(Particles, MeanHeadingCrossesPi) {
  Set set(2);
  Particles& p = set.particles;
  p.set_pose(0, {1.0, 2.0, std::numbers::pi - 0.1});
  p.set_pose(1, {3.0, 2.0, -std::numbers::pi + 0.3});
  p.weight[0] = 0.5;
  p.weight[1] = 0.5;
  const PoseEstimate e = estimate_pose(p);
  EXPECT_NEAR(wrap_angle(e.mean.theta_rad - (std::numbers::pi + 0.1)), 0.0, 1e-12);
  EXPECT_NEAR(e.mean.x_m, 2.0, 1e-12);
  EXPECT_NEAR(e.covariance(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(e.covariance(2, 2), 0.04, 1e-12);
  EXPECT_NEAR(e.covariance(0, 2), 0.2, 1e-12);
}

// The mean goes along with a motion of all particles, and with another start frame. The mean over
// coordinates of headings that spread by half a radian lies a twelfth inside of their arc.
TEST(Particles, TheMeanGoesAlongWithTheMotion) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kCount = 50;
  Set set(kCount);
  Particles& p = set.particles;
  for (int i = 0; i < kCount; ++i) {
    p.set_pose(i, {random.normal(), random.normal(), 2.9 + 0.5 * random.normal()});
    p.weight[static_cast<std::size_t>(i)] = 1.0 / kCount;
  }
  const Pose2 u = {3.0, -0.7, 0.4};
  const Pose2 T = {-20.0, 8.0, 2.0};
  const Pose2 expected = T * estimate_pose(p).mean * u;
  for (int i = 0; i < kCount; ++i) p.set_pose(i, T * p.pose(i) * u);
  const Pose2 got = estimate_pose(p).mean;
  EXPECT_LT((got.position() - expected.position()).norm(), 1e-9);
  EXPECT_NEAR(wrap_angle(got.theta_rad - expected.theta_rad), 0.0, 1e-9);
}

TEST(Particles, WeightsCountInTheEstimate) {
  Set set(2);
  set.particles.set_pose(0, {0.0, 0.0, 0.0});
  set.particles.set_pose(1, {4.0, 0.0, 0.0});
  set.particles.weight[0] = 0.75;
  set.particles.weight[1] = 0.25;
  const PoseEstimate e = estimate_pose(set.particles);
  EXPECT_NEAR(e.mean.x_m, 1.0, 1e-12);
  EXPECT_NEAR(e.covariance(0, 0), 3.0, 1e-12);
}

TEST(Particles, CamerasSitAtTheLever) {
  Set set(3);
  const Eigen::Vector2d lever(0.2, -0.1);
  const Pose2 poses[3] = {{1.0, 2.0, 0.0}, {-3.0, 0.5, 1.2}, {100.0, -80.0, -2.9}};
  for (int i = 0; i < 3; ++i) set.particles.set_pose(i, poses[i]);
  place_cameras(set.particles, lever);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d at = poses[i] * lever;
    const CameraRows& camera = set.particles.camera;
    EXPECT_NEAR(static_cast<double>(camera.x[i]), at.x(), 1e-5);
    EXPECT_NEAR(static_cast<double>(camera.y[i]), at.y(), 1e-5);
    EXPECT_NEAR(static_cast<double>(camera.cos[i]), std::cos(poses[i].theta_rad), 1e-7);
    EXPECT_NEAR(static_cast<double>(camera.sin[i]), std::sin(poses[i].theta_rad), 1e-7);
  }
}

}  // namespace
}  // namespace zenith
