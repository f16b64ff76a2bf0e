// The pose by the wheels alone, and how uncertain it is.

#include "slam/filter/dead_reckoning.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr Duration kTick = {100'000'000};
constexpr MotionNoise kNoise = {0.01, 0.03, 0.005, 0.001};

TEST(DeadReckoning, StaysInOneFrame) {
  const Wheels wheels{0.4, 1.0, 1.0};
  DeadReckoning odometry;
  EXPECT_EQ(odometry.odometry().T_odom_robot.x_m, 0.0);
  EXPECT_TRUE(odometry.odometry().covariance.isZero(0.0));
  // A quarter turn to the left on a circle of 1 m, in ten steps.
  const double quarter = 0.5 * std::numbers::pi;
  const WheelTravel step = {0.8 * quarter / 10.0, 1.2 * quarter / 10.0};
  for (int i = 1; i <= 10; ++i) odometry.advance(motion_increment(wheels, step, kNoise), kTick);
  const Odometry& found = odometry.odometry();
  EXPECT_NEAR(found.T_odom_robot.x_m, 1.0, 1e-12);
  EXPECT_NEAR(found.T_odom_robot.y_m, 1.0, 1e-12);
  EXPECT_NEAR(found.T_odom_robot.theta_rad, quarter, 1e-12);
  const double turn_rate = quarter;  // in a second
  EXPECT_NEAR(found.velocity.z(), turn_rate, 1e-9);
  EXPECT_NEAR(std::hypot(found.velocity.x(), found.velocity.y()), turn_rate, 2e-3);
  // Standing still is known, and adds nothing.
  const Eigen::Matrix3d before = found.covariance;
  odometry.advance({}, kTick);
  EXPECT_TRUE(odometry.odometry().velocity.isZero(0.0));
  EXPECT_TRUE(odometry.odometry().covariance.isApprox(before, 1e-12));
  // What took no time is left out.
  odometry.advance(motion_increment(wheels, step, kNoise), {0});
  EXPECT_NEAR(odometry.odometry().T_odom_robot.x_m, 1.0, 1e-12);
}

// Against the spread of drives whose increments were drawn from the same noise. With 20000 drives a
// standard deviation is known to 0.5 %; the linearisation is off by some percent at this turn.
TEST(DeadReckoning, ItsCovarianceIsTheSpreadOfDrives) {
  const Wheels wheels{0.4, 1.0, 1.0};
  const WheelTravel step{0.10, 0.13};
  constexpr int kSteps = 8;
  DeadReckoning odometry;
  const MotionIncrement u = motion_increment(wheels, step, kNoise);
  MotionIncrement whole;
  for (int i = 0; i < kSteps; ++i) {
    odometry.advance(u, kTick);
    whole = whole * u;
  }
  // The whole as one motion is the same.
  DeadReckoning at_once;
  at_once.advance(whole, kTick);
  EXPECT_LT(
      (at_once.odometry().T_odom_robot.position() - odometry.odometry().T_odom_robot.position())
          .norm(),
      1e-12);
  EXPECT_TRUE(at_once.odometry().covariance.isApprox(odometry.odometry().covariance, 1e-9));
  const Eigen::Matrix3d L = u.covariance.llt().matrixL();
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kDrives = 20000;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  const Pose2 mean = odometry.odometry().T_odom_robot;
  for (int drive = 0; drive < kDrives; ++drive) {
    Pose2 pose;
    for (int i = 0; i < kSteps; ++i) {
      const double a = random.normal();
      const double b = random.normal();
      const double c = random.normal();
      const Eigen::Vector3d xi = L * Eigen::Vector3d(a, b, c);
      pose = pose * u.mean * Pose2{xi.x(), xi.y(), xi.z()};
    }
    const Eigen::Vector3d d(pose.x_m - mean.x_m, pose.y_m - mean.y_m,
                            wrap_angle(pose.theta_rad - mean.theta_rad));
    spread += d * d.transpose() / kDrives;
  }
  const Eigen::Matrix3d& P = odometry.odometry().covariance;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(P(i, i)), std::sqrt(spread(i, i)), 0.05 * std::sqrt(spread(i, i)));
    for (int j = 0; j < i; ++j) {
      EXPECT_NEAR(P(i, j), spread(i, j), 0.08 * std::sqrt(spread(i, i) * spread(j, j)));
    }
  }
}

}  // namespace
}  // namespace zenith
