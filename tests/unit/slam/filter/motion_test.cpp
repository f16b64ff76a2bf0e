#include "slam/filter/motion.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "slam/filter/proposal.h"
#include "tests/support/arena_block.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr std::int64_t kMs = 1'000'000;

WheelSample sample(std::int64_t ms, double left_m, double right_m) {
  return {Time{ms * kMs}, left_m, right_m};
}

// The same motion by small steps of the unicycle.
Pose2 integrate(const Wheels& wheels, const WheelTravel& travel) {
  constexpr int kSteps = 100'000;
  const double left = travel.left_m * wheels.left_scale / kSteps;
  const double right = travel.right_m * wheels.right_scale / kSteps;
  Pose2 pose;
  for (int i = 0; i < kSteps; ++i) {
    const double d = 0.5 * (left + right);
    const double turn = (right - left) / wheels.track_width_m;
    pose.x_m += d * std::cos(pose.theta_rad + 0.5 * turn);
    pose.y_m += d * std::sin(pose.theta_rad + 0.5 * turn);
    pose.theta_rad += turn;
  }
  return pose;
}

TEST(WheelMotion, EqualsTheIntegratedArc) {
  const Wheels wheels = {0.42, 1.01, 0.99};
  for (const WheelTravel travel :
       {WheelTravel{0.5, 0.5}, WheelTravel{0.2, 0.6}, WheelTravel{-0.3, 0.3},
        WheelTravel{-0.4, -0.1}, WheelTravel{0.0, 1.3}}) {
    const Pose2 expected = integrate(wheels, travel);
    const Pose2 got = wheel_motion(wheels, travel);
    EXPECT_NEAR(got.x_m, expected.x_m, 1e-9);
    EXPECT_NEAR(got.y_m, expected.y_m, 1e-9);
    EXPECT_NEAR(got.theta_rad, expected.theta_rad, 1e-9);
  }
}

TEST(WheelMotion, HalvesMakeTheWhole) {
  const Wheels wheels;
  const Pose2 whole = wheel_motion(wheels, {0.3, 0.5});
  const Pose2 half = wheel_motion(wheels, {0.15, 0.25});
  const Pose2 twice = half * half;
  EXPECT_NEAR(twice.x_m, whole.x_m, 1e-12);
  EXPECT_NEAR(twice.y_m, whole.y_m, 1e-12);
  EXPECT_NEAR(twice.theta_rad, whole.theta_rad, 1e-12);
}

TEST(MotionIncrement, VarianceGrowsWithTheWayAlone) {
  const Wheels wheels;
  const MotionNoise noise = {0.01, 0.03, 0.004, 0.0};
  const MotionIncrement one = motion_increment(wheels, {0.1, 0.1}, noise);
  const MotionIncrement ten = motion_increment(wheels, {1.0, 1.0}, noise);
  EXPECT_LT((ten.covariance - 10.0 * one.covariance).norm(), 1e-15);
  EXPECT_NEAR(std::sqrt(ten.covariance(0, 0)), 0.01, 1e-12);
  EXPECT_NEAR(std::sqrt(ten.covariance(1, 1)), 0.004, 1e-12);
  EXPECT_NEAR(std::sqrt(ten.covariance(2, 2)), 0.03, 1e-12);
  const MotionIncrement back = motion_increment(wheels, {-1.0, -1.0}, noise);
  EXPECT_EQ(back.covariance, ten.covariance);
}

TEST(MotionIncrement, StandingRobotHasNoNoise) {
  const MotionIncrement none = motion_increment({}, {}, {});
  EXPECT_TRUE(none.covariance.isZero(0.0));
  EXPECT_EQ(none.mean.x_m, 0.0);
}

// The moments of 40 000 particles that start in one pose, in that pose's axes: a mean has the
// deviation sigma / sqrt(n), a variance sqrt(2 / n) of itself, a covariance 1 / sqrt(n) of the
// product of sigmas. Five deviations each: one false alarm in some 200 000 seeds.
TEST(MotionModel, SamplesHaveTheStatedMoments) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kSamples = 40'000;
  Particles particles;
  const ArenaBlock block([&particles](Arena& arena) { particles.layout(arena, kSamples); });
  const Wheels wheels;
  const MotionNoise noise = {0.02, 0.05, 0.01, 0.001};
  const MotionIncrement motion = motion_increment(wheels, {0.5, 0.7}, noise);
  const Pose2 start = {3.0, -2.0, 2.5};
  for (int i = 0; i < kSamples; ++i) particles.set_pose(i, start);
  move_by_sample(particles, motion, random);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Pose2 moved = start.inverse() * particles.pose(i);
    const Eigen::Vector3d d(moved.x_m - motion.mean.x_m, moved.y_m - motion.mean.y_m,
                            wrap_angle(moved.theta_rad - motion.mean.theta_rad));
    mean += d / kSamples;
    second += d * d.transpose() / kSamples;
  }
  const Eigen::Vector3d sigma = motion.covariance.diagonal().cwiseSqrt();
  const double root = std::sqrt(static_cast<double>(kSamples));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(mean[i], 0.0, 5.0 * sigma[i] / root) << i;
    EXPECT_NEAR(second(i, i), sigma[i] * sigma[i],
                5.0 * std::numbers::sqrt2 * sigma[i] * sigma[i] / root)
        << i;
    for (int k = 0; k < i; ++k) {
      EXPECT_NEAR(second(i, k), 0.0, 5.0 * sigma[i] * sigma[k] / root) << i << ' ' << k;
    }
  }
}

TEST(MotionModel, StandingParticlesStay) {
  Particles particles;
  const ArenaBlock block([&particles](Arena& arena) { particles.layout(arena, 16); });
  Random random(1);
  for (int i = 0; i < 16; ++i) particles.set_pose(i, {1.0 * i, 2.0, 0.1 * i});
  move_by_sample(particles, motion_increment({}, {}, {}), random);
  for (int i = 0; i < 16; ++i) {
    EXPECT_EQ(particles.pose(i).x_m, 1.0 * i);
    EXPECT_EQ(particles.pose(i).y_m, 2.0);
    EXPECT_NEAR(particles.pose(i).theta_rad, 0.1 * i, 1e-15);
  }
}

TEST(WheelHistory, InterpolatesBetweenSamples) {
  WheelHistory history;
  EXPECT_FALSE(history.at(Time{5}).known);
  EXPECT_TRUE(history.add(sample(0, 0.0, 0.0)));
  EXPECT_TRUE(history.add(sample(10, 0.10, 0.20)));
  EXPECT_TRUE(history.add(sample(20, 0.30, 0.20)));
  const auto at = history.at(Time{5 * kMs});
  EXPECT_TRUE(at.known);
  EXPECT_FALSE(at.extrapolated);
  EXPECT_NEAR(at.total.left_m, 0.05, 1e-12);
  EXPECT_NEAR(at.total.right_m, 0.10, 1e-12);
  EXPECT_NEAR(history.at(Time{15 * kMs}).total.left_m, 0.20, 1e-12);
  EXPECT_FALSE(history.at(Time{20 * kMs}).extrapolated);
}

TEST(WheelHistory, HoldsTheSpeedForATenthOfASecond) {
  WheelHistory history;
  history.add(sample(0, 0.0, 0.0));
  history.add(sample(10, 0.01, 0.02));
  const auto near = history.at(Time{30 * kMs});
  EXPECT_TRUE(near.extrapolated);
  EXPECT_NEAR(near.total.left_m, 0.03, 1e-12);
  EXPECT_NEAR(history.at(Time{5000 * kMs}).total.right_m, 0.22, 1e-12);
}

TEST(WheelHistory, RefusesWhatIsNotNewerOrNoNumber) {
  WheelHistory history;
  EXPECT_TRUE(history.add(sample(10, 0.0, 0.0)));
  EXPECT_FALSE(history.add(sample(10, 1.0, 1.0)));
  EXPECT_FALSE(history.add(sample(5, 1.0, 1.0)));
  EXPECT_FALSE(history.add(sample(20, std::numeric_limits<double>::quiet_NaN(), 0.0)));
  EXPECT_FALSE(history.add(sample(20, 0.0, std::numeric_limits<double>::infinity())));
  EXPECT_EQ(history.at(Time{10 * kMs}).total.left_m, 0.0);
}

// What a wheel cannot do is no travel: the total goes on from there.
TEST(WheelHistory, ATotalThatJumpsGoesOnFromThere) {
  WheelHistory history;
  EXPECT_TRUE(history.add(sample(0, 7.0, 7.0)));
  EXPECT_TRUE(history.add(sample(10, 7.1, 7.2)));
  EXPECT_TRUE(history.add(sample(20, 1e6, -1e8)));
  EXPECT_EQ(history.jumps(), 1u);
  EXPECT_TRUE(history.add(sample(30, 1e6 + 0.1, -1e8 + 0.1)));
  const auto at = history.at(Time{30 * kMs});
  EXPECT_NEAR(at.total.left_m, 7.2, 1e-7);
  EXPECT_NEAR(at.total.right_m, 7.3, 1e-7);
  EXPECT_FALSE(history.add(sample(40, 1e300, 0.0)));
  EXPECT_EQ(history.jumps(), 1u);
  // After a pause a robot may be far away.
  EXPECT_TRUE(history.add(sample(5'000, 1e6 + 20.0, -1e8 + 20.0)));
  EXPECT_EQ(history.jumps(), 1u);
}

TEST(WheelHistory, TwoSamplesRightAfterEachOtherTellNoSpeed) {
  WheelHistory history;
  history.add({Time{1'000'000}, 0.0, 0.0});
  history.add({Time{1'000'001}, 0.01, 0.01});
  EXPECT_NEAR(history.at(Time{50 * kMs}).total.left_m, 0.01, 1e-12) << "not 490 km further";
}

// One sample from the future must not silence the wheels for years.
TEST(WheelHistory, FollowsAClockThatWasSetBack) {
  WheelHistory history;
  history.add(sample(0, 0.0, 0.0));
  history.add(sample(10, 0.1, 0.1));
  EXPECT_TRUE(history.add(sample(1'000'000'000'000, 0.2, 0.2)));
  int refused = 0;
  int ms = 20;
  while (!history.add(sample(ms, 0.3, 0.3)) && refused < 100) {
    ++refused;
    ms += 10;
  }
  EXPECT_EQ(refused, kOtherClockSamples - 1);
  EXPECT_TRUE(history.add(sample(ms + 10, 0.4, 0.5)));
  const auto at = history.at(Time{(ms + 10) * kMs});
  EXPECT_NEAR(at.total.left_m, 0.4, 1e-12);
  EXPECT_NEAR(at.total.right_m, 0.5, 1e-12);
  EXPECT_EQ(history.jumps(), 0u);
}

// What merely comes out of order is refused for good.
TEST(WheelHistory, LateSamplesAreNoOtherClock) {
  WheelHistory history;
  history.add(sample(10'000, 0.0, 0.0));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(history.add(sample(9'100 + i % 800, 1.0, 1.0))) << i;
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(history.add(sample(1'000 - i, 1.0, 1.0))) << i;
}

TEST(WheelHistory, RefusesStampsWhoseDifferencesDoNotFit) {
  WheelHistory history;
  history.add(sample(0, 0.0, 0.0));
  EXPECT_FALSE(history.add({Time{std::numeric_limits<std::int64_t>::max()}, 0.0, 0.0}));
  EXPECT_FALSE(history.add({Time{std::numeric_limits<std::int64_t>::min()}, 0.0, 0.0}));
  EXPECT_TRUE(history.add(sample(10, 0.0, 0.0)));
}

TEST(WheelHistory, FullForgetsTheOldest) {
  WheelHistory history;
  constexpr int kSamples = 3 * kMaxWheelSamples + 17;
  for (int i = 0; i < kSamples; ++i) ASSERT_TRUE(history.add(sample(i, 0.001 * i, 0.002 * i)));
  const int oldest = kSamples - kMaxWheelSamples;
  for (int i = oldest; i < kSamples; ++i) {
    ASSERT_NEAR(history.at(Time{i * kMs}).total.left_m, 0.001 * i, 1e-12) << i;
  }
  const auto before = history.at(Time{(oldest - 1) * kMs});
  EXPECT_TRUE(before.extrapolated);
  EXPECT_NEAR(before.total.left_m, 0.001 * oldest, 1e-12);
}

}  // namespace
}  // namespace zenith
