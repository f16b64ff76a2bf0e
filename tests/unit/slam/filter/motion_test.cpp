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

// The moments of 40 000 particles that start in one pose, in the axes of where the motion ends: a
// mean has the deviation sigma / sqrt(n), a variance sqrt(2 / n) of itself, a covariance 1 /
// sqrt(n) of the product of sigmas. Five deviations each: one false alarm in some 200 000 seeds.
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
  move_by_mean(particles, motion.mean);
  draw_from_motion(particles, motion.covariance, random);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Pose2 off = (start * motion.mean).inverse() * particles.pose(i);
    const Eigen::Vector3d d(off.x_m, off.y_m, off.theta_rad);
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
  const MotionIncrement none = motion_increment({}, {}, {});
  move_by_mean(particles, none.mean);
  draw_from_motion(particles, none.covariance, random);
  for (int i = 0; i < 16; ++i) {
    EXPECT_EQ(particles.pose(i).x_m, 1.0 * i);
    EXPECT_EQ(particles.pose(i).y_m, 2.0);
    EXPECT_NEAR(particles.pose(i).theta_rad, 0.1 * i, 1e-15);
  }
}

constexpr MotionNoise kNoise = {0.001, 0.02, 0.002, 0.0003};
constexpr std::int64_t kPeriod_ms = 10;

// The wheels of a robot that drives a slalom, in samples of 10 ms.
WheelSample slalom(std::int64_t k) {
  const double t = 0.01 * static_cast<double>(k);
  const double bend = 0.3 * std::sin(1.7 * t);
  return sample(k * kPeriod_ms, 12.0 + 0.5 * t - bend, 12.0 + 0.5 * t + bend);
}

// A motion from one sample to another, arc by arc.
MotionIncrement driven(const Wheels& wheels, std::int64_t from, std::int64_t to) {
  MotionNoise noise = kNoise;
  noise.floor_m = 0.0;
  MotionIncrement out;
  for (std::int64_t k = from; k < to; ++k) {
    const WheelSample a = slalom(k);
    const WheelSample b = slalom(k + 1);
    out = out * motion_increment(wheels, {b.left_m - a.left_m, b.right_m - a.right_m}, noise);
  }
  return out;
}

void expect_same(const MotionIncrement& got, const MotionIncrement& expected) {
  EXPECT_LT((got.mean.position() - expected.mean.position()).norm(), 1e-9);
  EXPECT_NEAR(wrap_angle(got.mean.theta_rad - expected.mean.theta_rad), 0.0, 1e-9);
  EXPECT_LT((got.covariance - expected.covariance).norm(), 1e-6 * expected.covariance.norm());
}

// Frames come every so many samples, and not at all for `gap` of them after the first second.
void expect_every_arc(std::int64_t period, std::int64_t gap) {
  const Wheels wheels = {0.42, 1.01, 0.99};
  WheelMotion motion;
  motion.build(wheels, kNoise);
  MotionIncrement whole;
  std::int64_t last = -1;
  std::int64_t next = 0;
  const std::int64_t end = 400 + gap;
  for (std::int64_t k = 0; k <= end; ++k) {
    ASSERT_TRUE(motion.add(slalom(k)));
    if (k != next) continue;
    next += k == 10 * period ? gap : period;
    const WheelMotion::Since since = motion.advance(slalom(k).stamp);
    EXPECT_TRUE(since.known);
    if (last >= 0) expect_same(since.motion, driven(wheels, last, k));
    whole = whole * since.motion;
    last = k;
  }
  EXPECT_GT(last, 300 + gap);
  expect_same(whole, driven(wheels, 0, last));
}

TEST(WheelMotion, EqualsEveryArcOfTheWheelsHoweverFarFramesAreApart) {
  expect_every_arc(10, 10);
  expect_every_arc(7, 30);
  expect_every_arc(10, 250);  // more than a second
  expect_every_arc(10, 400);  // more than the history holds
  expect_every_arc(10, 5 * kMaxWheelSamples + 3);
}

TEST(WheelMotion, OneArcOverAGapIsFarOff) {
  const WheelSample a = slalom(100);
  const WheelSample b = slalom(500);
  const Pose2 arc = wheel_motion({}, {b.left_m - a.left_m, b.right_m - a.right_m});
  EXPECT_GT((arc.position() - driven({}, 100, 500).mean.position()).norm(), 0.1);
}

// Frames between samples: an arc that a frame cuts goes on in the next interval.
TEST(WheelMotion, LosesNothingBetweenSamples) {
  const Wheels wheels;
  WheelMotion motion;
  motion.build(wheels, kNoise);
  MotionIncrement whole;
  for (int k = 0; k <= 500; ++k) {
    ASSERT_TRUE(motion.add(slalom(k)));
    if (k == 0) motion.advance(slalom(0).stamp);
    if (k % 9 != 4) continue;
    whole = whole * motion.advance(slalom(k).stamp - Duration{3'700'000}).motion;
  }
  whole = whole * motion.advance(slalom(500).stamp).motion;
  const MotionIncrement expected = driven(wheels, 0, 500);
  EXPECT_LT((whole.mean.position() - expected.mean.position()).norm(), 1e-9);
  EXPECT_NEAR(whole.covariance(2, 2), expected.covariance(2, 2), 1e-6 * expected.covariance(2, 2));
}

TEST(WheelMotion, BeginsAtTheFirstKnownTravelAndStandsWithoutNoise) {
  WheelMotion motion;
  motion.build({}, kNoise);
  EXPECT_FALSE(motion.advance(Time{5 * kMs}).known);
  ASSERT_TRUE(motion.add(sample(10, 120.0, 80.0)));
  ASSERT_TRUE(motion.add(sample(20, 120.0, 80.0)));
  const WheelMotion::Since first = motion.advance(Time{20 * kMs});
  EXPECT_TRUE(first.known);
  EXPECT_EQ(first.motion.mean.x_m, 0.0);
  ASSERT_TRUE(motion.add(sample(30, 120.0, 80.0)));
  const MotionIncrement stood = motion.advance(Time{30 * kMs}).motion;
  EXPECT_TRUE(motion.with_floor(stood).covariance.isZero(0.0));
  ASSERT_TRUE(motion.add(sample(40, 120.01, 80.01)));
  const MotionIncrement moved = motion.advance(Time{40 * kMs}).motion;
  EXPECT_NEAR(moved.mean.x_m, 0.01, 1e-9);
  EXPECT_TRUE(motion.with_floor(moved).covariance.isApprox(
      motion_increment({}, {0.01, 0.01}, kNoise).covariance, 1e-6));
}

// After the clock was set back travel goes on, whichever of wheels and frames is told first.
TEST(WheelMotion, FollowsAClockThatWasSetBack) {
  const auto way = [](std::int64_t k) { return 0.01 * static_cast<double>(k); };
  WheelMotion motion;
  motion.build({}, kNoise);
  for (std::int64_t k = 0; k <= 100; ++k) motion.add(sample(100'000 + k * 10, way(k), way(k)));
  motion.advance(Time{101'000 * kMs});
  MotionIncrement whole;
  for (std::int64_t k = 0; k <= 100; ++k) {
    motion.add(sample(k * 10, 1.0 + way(k), 1.0 + way(k)));
    if (k > 30 && k % 10 == 0) whole = whole * motion.advance(Time{k * 10 * kMs}).motion;
  }
  EXPECT_NEAR(whole.mean.x_m, 1.0, 1e-9);
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
