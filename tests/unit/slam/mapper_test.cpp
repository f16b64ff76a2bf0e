// The whole filter in the world of points: loops, determinism, calibration, rest.

#include "slam/mapper.h"

#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/figure.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

RobotConfig test_robot() {
  RobotConfig robot;
  robot.mount.x_m = 0.05;
  robot.mount.y_m = -0.02;
  return robot;
}

Parameters honest_parameters() {
  Parameters p;
  p.pixel_sigma_px = 0.5;
  p.tilt_sigma_deg = 0.0;
  p.distance_noise_per_sqrt_m = 0.005;
  p.turn_noise_per_sqrt_m = 0.02;
  p.lateral_noise_per_sqrt_m = 0.003;
  return p;
}

// A step of `length_m` on a circle of `way_m` circumference.
Pose2 arc_step(double length_m, double way_m) {
  const double turn = 2.0 * std::numbers::pi * length_m / way_m;
  return {length_m, 0.0, turn};
}

// A long way under a ceiling with few new landmarks a metre uses up the anchors before the
// landmarks. The oldest places then give way, and the robot still sees a map where it is.
TEST(Mapper, GoesOnWhenTheAnchorsAreUsedUp) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr double kStep_m = 0.12;
  constexpr int kSteps = 2 * kMaxAnchors + 700;
  const double way_m = kStep_m * kSteps;
  const PointWorld world =
      PointWorld::scatter(random, static_cast<int>(12.0 * way_m), -4.0, way_m + 4.0, -4.0, 4.0);
  Parameters p = honest_parameters();
  p.particles = 8;
  auto rig = std::make_unique<MapperRig>(test_robot(), p, seed.value());
  rig->drive({}, world, random);
  for (int i = 0; i < kSteps; ++i) {
    const double back_to_the_middle = -0.05 * rig->truth().theta_rad - 0.01 * rig->truth().y_m;
    rig->drive({kStep_m, 0.0, back_to_the_middle}, world, random);
  }
  const MapperCounters& counters = rig->mapper().counters();
  EXPECT_GT(counters.landmarks_evicted, 0u);
  EXPECT_EQ(counters.landmarks_rejected_full, 0u);
  int followed = 0;
  for (const Candidate& c : rig->mapper().candidates()) followed += c.inlier ? 1 : 0;
  EXPECT_GT(followed, 30);
}

// Drives `rig` straight on for 2 m, its wheels telling `first_told` of the first half metre, and
// then 3 m more. The last 3 m must have their right length.
void expect_right_scale_in_the_end(MapperRig& rig, const PointWorld& world, Random& random,
                                   double first_told) {
  rig.drive({}, world, random);
  for (int i = 0; i < 20; ++i) {
    rig.drive({0.1, 0.0, 0.0}, world, random, i < 5 ? first_told : 1.0);
  }
  const Eigen::Vector3d before = rig.error();
  const std::uint64_t slips = rig.mapper().counters().slips;
  for (int i = 0; i < 30; ++i) rig.drive({0.1, 0.0, 0.0}, world, random);
  EXPECT_LT((rig.error() - before).head<2>().norm(), 0.06);
  EXPECT_LT(rig.mapper().counters().slips - slips, 3u);
}

// Where the first frames lie farther apart than the wheels tell, under a ceiling that is higher
// than expected, all depths come out too small, and all later wheels would look as if they slipped.
// Such a map is given up while it is young.
TEST(Mapper, GivesUpAYoungMapOfWrongScale) {
  const TestSeed seed;
  Random random(seed.value());
  Parameters p = honest_parameters();
  p.distance_noise_per_sqrt_m = Parameters{}.distance_noise_per_sqrt_m;  // trusted wheels
  const PointWorld room = PointWorld::scatter(random, 1500, -4.0, 14.0, -4.0, 4.0);
  auto honest = std::make_unique<MapperRig>(test_robot(), p, seed.value());
  expect_right_scale_in_the_end(*honest, room, random, 1.0);
  EXPECT_EQ(honest->mapper().counters().begun_anew, 0u);
  const PointWorld hall = PointWorld::scatter(random, 3000, -6.0, 16.0, -6.0, 6.0, 3.8, 4.2);
  auto misled = std::make_unique<MapperRig>(test_robot(), p, seed.value());
  expect_right_scale_in_the_end(*misled, hall, random, 0.6);
  EXPECT_GE(misled->mapper().counters().begun_anew, 1u);
}

// After a circle of 40 m under a ceiling of 18 m x 18 m, the robot knows where it is to 0.3 % of
// its way: 12 cm. Dead reckoning with the same wheels errs by metres: the heading alone spreads by
// 0.02 sqrt(40) = 0.13 rad.
TEST(Mapper, ClosesACircleOfFortyMetres) {
  const TestSeed seed;
  constexpr double kWay_m = 40.0;
  double worst = 0.0;
  for (std::uint64_t run = 0; run < 3; ++run) {
    Random random(seed.value() + run);
    const PointWorld world = PointWorld::scatter(random, 450, -10.0, 10.0, -3.5, 16.5);
    auto rig = std::make_unique<MapperRig>(test_robot(), honest_parameters(), seed.value() + run);
    constexpr int kSteps = 800;
    rig->drive({}, world, random);
    for (int i = 0; i < kSteps; ++i) rig->drive(arc_step(kWay_m / kSteps, kWay_m), world, random);
    const double error = rig->error().head<2>().norm();
    worst = std::max(worst, error);
    EXPECT_LT(error, 0.003 * kWay_m) << "run " << run;
    EXPECT_LT(std::abs(rig->error().z()), 0.02) << "run " << run;
    EXPECT_GT(rig->mapper().counters().landmarks_promoted, 200U);
    EXPECT_GT(rig->mapper().counters().loops_closed, 0U);
  }
  print_figure("mapper: 40 m circle, error at the return at most %.3f m (%.2f %%)", worst,
               100.0 * worst / kWay_m);
}

// The map is right too: promoted landmarks lie where the world's are, in the robot's start frame.
TEST(Mapper, LandmarksLieWhereTheyAre) {
  const TestSeed seed;
  Random random(seed.value());
  const PointWorld world = PointWorld::scatter(random, 200, -5.0, 12.0, -5.0, 5.0);
  auto rig = std::make_unique<MapperRig>(test_robot(), honest_parameters(), seed.value());
  rig->drive({}, world, random);
  for (int i = 0; i < 120; ++i) rig->drive({0.05, 0.0, 0.002}, world, random);
  int promoted = 0;
  for (const LandmarkInfo& l : rig->mapper().map().landmarks()) {
    if (l.state != LandmarkState::kPromoted) continue;
    ++promoted;
    double nearest = 1e9;
    for (const auto& truth : world.landmarks) {
      nearest = std::min(nearest, (truth.p_m - l.position_m()).norm());
    }
    // Five of its own sigmas, and a centimetre or two of common drift.
    EXPECT_LT(nearest, 0.03 + 5.0 * std::sqrt(l.covariance().trace())) << "landmark " << l.id;
  }
  EXPECT_GT(promoted, 65);  // of some 100 points that came into view
}

// Everything that a run leaves behind, as bytes: poses, weights, and the rows of all landmarks.
std::vector<unsigned char> imprint(Mapper& mapper) {
  std::vector<unsigned char> bytes;
  const auto add = [&bytes](const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), p, p + size);
  };
  const Particles& particles = mapper.particles();
  const auto n = static_cast<std::size_t>(particles.count);
  add(particles.x_m.data(), n * sizeof(double));
  add(particles.y_m.data(), n * sizeof(double));
  add(particles.theta_rad.data(), n * sizeof(double));
  add(particles.weight.data(), n * sizeof(double));
  const auto landmarks = mapper.map().landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    if (landmarks[slot].state == LandmarkState::kFree) continue;
    add(&landmarks[slot].id, sizeof(std::uint32_t));
    const LandmarkRows rows = mapper.map().rows(static_cast<int>(slot));
    for (const float* row :
         {rows.ax, rows.ay, rows.rho, rows.pxx, rows.pxy, rows.pxr, rows.pyy, rows.pyr, rows.prr}) {
      add(row, n * sizeof(float));
    }
  }
  return bytes;
}

std::vector<unsigned char> short_run(std::uint64_t world_seed, std::uint64_t filter_seed,
                                     Parameters parameters) {
  Random random(world_seed);
  const PointWorld world = PointWorld::scatter(random, 120, -5.0, 7.0, -5.0, 5.0);
  auto rig = std::make_unique<MapperRig>(test_robot(), parameters, filter_seed);
  rig->drive({}, world, random);
  for (int i = 0; i < 60; ++i) rig->drive({0.05, 0.0, 0.02}, world, random);
  return imprint(rig->mapper());
}

TEST(Mapper, SameInputsSameBits) {
  const TestSeed seed;
  for (const int optimal : {0, 1}) {
    Parameters p = honest_parameters();
    p.optimal_proposal = optimal;
    p.tilt_sigma_deg = 0.2;  // with everything that may run
    const auto a = short_run(seed.value(), 7, p);
    EXPECT_EQ(a, short_run(seed.value(), 7, p)) << "optimal " << optimal;
    EXPECT_NE(a, short_run(seed.value(), 8, p)) << "the filter's seed must matter";
    EXPECT_NE(a, short_run(seed.value() + 1, 7, p)) << "the inputs must matter";
  }
}

// A camera that leans 0.15 degrees forward more than its calibration says: learned while driving.
// The truth of beta is where the level image would be: z_true = z_seen + C beta. On a way that only
// ever turns to one side the lean to that side comes out too large, by up to half of the forward
// tilt; this way turns to both.
TEST(Mapper, LearnsTheCamerasTilt) {
  const TestSeed seed;
  Random random(seed.value());
  const PointWorld world = PointWorld::scatter(random, 900, -16.0, 26.0, -16.0, 16.0);
  Parameters p = honest_parameters();
  p.tilt_sigma_deg = 0.3;
  auto rig = std::make_unique<MapperRig>(test_robot(), p, seed.value());
  CalibrationVector beta = CalibrationVector::Zero();
  beta[0] = 0.15 * std::numbers::pi / 180.0;
  Pose2 truth;
  for (int i = 0; i <= 500; ++i) {
    const Pose2 step = i == 0 ? Pose2{} : Pose2{0.05, 0.0, 0.03 * std::sin(0.03 * i)};
    const WheelTravel travel = point_world::wheel_travel({}, step.x_m, step.theta_rad);
    truth = truth * wheel_motion({}, travel);
    world.observe(truth, test_robot(), rig->view().pinhole(), 0.5, random, rig->features());
    for (Feature& f : rig->features()) {
      const Eigen::Vector2d z(static_cast<double>(f.zx), static_cast<double>(f.zy));
      const Eigen::Vector2d seen = z - calibration_effect(z) * beta;
      f.zx = static_cast<float>(seen.x());
      f.zy = static_cast<float>(seen.y());
    }
    rig->mapper().update(motion_increment({}, travel, rig->mapper().motion_noise()),
                         rig->features(), rig->view());
  }
  const CalibrationVector learned = rig->mapper().calibration().beta();
  constexpr double kDegree = std::numbers::pi / 180.0;
  print_figure("mapper: tilt of 0.150 deg learned as (%.3f, %.3f) deg", learned[0] / kDegree,
               learned[1] / kDegree);
  EXPECT_NEAR(learned[0], beta[0], 0.05 * kDegree);
  EXPECT_NEAR(learned[1], 0.0, 0.05 * kDegree);
}

MotionIncrement by_wheels(double left_m, double right_m) {
  return motion_increment({}, {left_m, right_m}, {});
}

TEST(Mapper, UsesNoFrameWhileTheRobotStands) {
  auto rig = std::make_unique<MapperRig>(test_robot(), honest_parameters(), 1);
  EXPECT_TRUE(rig->mapper().worth_using({}));  // the first
  rig->mapper().update({}, rig->features(), rig->view());
  EXPECT_FALSE(rig->mapper().worth_using({}));
  EXPECT_FALSE(rig->mapper().worth_using(by_wheels(0.002, 0.002)));
  EXPECT_TRUE(rig->mapper().worth_using(by_wheels(0.006, 0.006)));
  EXPECT_TRUE(rig->mapper().worth_using(by_wheels(-0.002, 0.002)));  // turns by 0.57 degrees
}

}  // namespace
}  // namespace zenith
