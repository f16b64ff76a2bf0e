// With nothing to see the pose is the wheels', and vision takes over again where they led.

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "slam/filter/dead_reckoning.h"
#include "tests/support/figure.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

constexpr Duration kTick = {100'000'000};

// What the wheels tell of a step, and what the mapper is told.
MotionIncrement told(const MapperRig& rig, const Pose2& step) {
  const Wheels& wheels = rig.mapper().robot().wheels;
  return motion_increment(wheels, point_world::wheel_travel(wheels, step.x_m, step.theta_rad),
                          rig.mapper().motion_noise());
}

Pose2 slalom(int i) {
  return {0.05, 0.0, 0.06 * std::sin(0.05 * i) + 0.01};
}

void expect_the_wheels_pose(const PoseEstimate& pose, const PoseEstimate& wheels,
                            double tolerance) {
  EXPECT_LT((pose.mean.position() - wheels.mean.position()).norm(), tolerance);
  EXPECT_NEAR(wrap_angle(pose.mean.theta_rad - wheels.mean.theta_rad), 0.0, tolerance);
  EXPECT_LT((pose.covariance - wheels.covariance).norm(),
            100.0 * tolerance * wheels.covariance.norm());
}

// Of each promoted landmark: the frames that must have shown it.
std::vector<int> frames_visible(const Map& map) {
  std::vector<int> out;
  for (const LandmarkInfo& l : map.landmarks()) {
    if (l.state == LandmarkState::kPromoted) out.push_back(l.chances);
  }
  return out;
}

// 25 m of slalom. The mean over particles that each drew their own heading would lie inside of the
// arc on which they are, by a quarter of the turn noise's variance a metre: here by 12 %.
TEST(MapperBlind, ThePoseIsTheWheels) {
  const TestSeed seed;
  Random random(seed.value());
  for (const int optimal : {0, 1}) {
    Parameters p;
    p.optimal_proposal = optimal;
    auto rig = std::make_unique<MapperRig>(RobotConfig{}, p, seed.value());
    DeadReckoning wheels;
    rig->drive({}, {}, random);
    for (int i = 0; i < 500; ++i) {
      rig->drive(slalom(i), {}, random);
      wheels.advance(told(*rig, slalom(i)), kTick);
    }
    const Odometry& odometry = wheels.odometry();
    expect_the_wheels_pose(rig->mapper().pose(), {odometry.T_odom_robot, odometry.covariance},
                           1e-6);
    EXPECT_NEAR(rig->mapper().travelled_m(), 25.0, 0.01);
    EXPECT_EQ(rig->mapper().map().size(), 0);
    EXPECT_EQ(rig->mapper().counters().frames_blind, 500u);
    EXPECT_TRUE(rig->mapper().blind());
  }
}

// Corners that come and go make landmarks that are never seen again: particles are drawn with each
// of them. Their mean is still not shorter than the wheels' way.
TEST(MapperBlind, CornersOfNoiseDoNotShortenTheWay) {
  const TestSeed seed;
  Random random(seed.value());
  auto rig = std::make_unique<MapperRig>(RobotConfig{}, Parameters{}, seed.value());
  PoseEstimate wheels;
  double shortest = 1.0;
  double longest = 1.0;
  rig->drive({}, {}, random);
  for (int i = 0; i < 400; ++i) {
    const PointWorld noise =
        PointWorld::scatter(random, 60, rig->truth().x_m - 3.0, rig->truth().x_m + 3.0,
                            rig->truth().y_m - 3.0, rig->truth().y_m + 3.0);
    rig->drive({0.05, 0.0, 0.0}, noise, random);
    wheels = wheels * told(*rig, {0.05, 0.0, 0.0});
    if (i < 100) continue;
    const double share = rig->mapper().pose().mean.x_m / wheels.mean.x_m;
    shortest = std::min(shortest, share);
    longest = std::max(longest, share);
  }
  print_figure("mapper: corners of noise over 20 m, %.3f to %.3f of the wheels' way", shortest,
               longest);
  EXPECT_GT(shortest, 0.98);
  EXPECT_LT(longest, 1.02);
}

// Blind for 3 m within the map, in a curve: the path goes on where the wheels led, as uncertain as
// they are, and when the map is seen again the pose is corrected by what they erred, no more.
TEST(MapperBlind, VisionTakesOverAgain) {
  const TestSeed seed;
  constexpr int kRuns = 6;
  double squares = 0.0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    Random random(seed.value() + run);
    const PointWorld world = PointWorld::scatter(random, 350, -5.0, 12.0, -6.0, 6.0);
    auto rig = std::make_unique<MapperRig>(RobotConfig{}, Parameters{}, seed.value() + run);
    rig->drive({}, world, random);
    for (int i = 0; i < 40; ++i) rig->drive({0.05, 0.0, 0.0}, world, random);
    const PoseEstimate before = rig->mapper().pose();
    const std::vector<int> seen = frames_visible(rig->mapper().map());
    PoseEstimate wheels = before;
    for (int i = 0; i < 60; ++i) {
      rig->drive({0.05, 0.0, 0.01}, {}, random);
      wheels = wheels * told(*rig, {0.05, 0.0, 0.01});
    }
    // The last resampling of those that saw the map moved their mean by less than this.
    expect_the_wheels_pose(rig->mapper().pose(), wheels, 5e-3);
    EXPECT_EQ(frames_visible(rig->mapper().map()), seen);
    const Eigen::Vector3d error = rig->error();
    squares += error.dot(rig->mapper().pose().covariance.ldlt().solve(error)) / 3.0;
    for (int i = 0; i < 20; ++i) rig->drive({0.05, 0.0, 0.0}, world, random);
    EXPECT_FALSE(rig->mapper().blind());
    EXPECT_LT(rig->error().head<2>().norm(), 0.02) << "run " << run;
    EXPECT_LT(std::abs(rig->error().z()), 0.01) << "run " << run;
  }
  // Chi squared of 18 degrees of freedom, by its mean: within [0.26, 2.4] in all but one of 1000.
  EXPECT_GT(squares / kRuns, 0.2);
  EXPECT_LT(squares / kRuns, 2.5);
}

}  // namespace
}  // namespace zenith
