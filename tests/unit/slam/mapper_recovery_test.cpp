// Wheels that slip, robots that are pushed, lifted, or put down where there is no map: the mapper
// goes on at the right place, or says that it does not know it and leaves its map alone.

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "slam/mapper.h"
#include "tests/support/figure.h"
#include "tests/support/mapper_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using point_world::MapperRig;
using point_world::PointWorld;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStep_m = 0.05;
constexpr int kRuns = 10;

Parameters quiet_parameters() {
  Parameters p;
  p.pixel_sigma_px = 0.5;
  p.tilt_sigma_deg = 0.0;
  return p;
}

// A robot whose wheels do not always tell what it does.
class Robot {
 public:
  Robot(const PointWorld& world, std::uint64_t seed)
      : world_(world), random_(seed), rig_(RobotConfig{}, quiet_parameters(), seed) {
    step({}, {});
  }

  // One frame: the robot moves, its wheels tell another motion.
  void step(const Pose2& moves, const Pose2& told) {
    truth_ = truth_ * moves;
    Mapper& mapper = rig_.mapper();
    const WheelTravel travel = point_world::wheel_travel({}, told.x_m, told.theta_rad);
    const MotionIncrement moved = motion_increment({}, travel, mapper.motion_noise());
    world_.observe(truth_, mapper.robot(), rig_.view().pinhole(), 0.5, random_, rig_.features());
    if (covered_) rig_.features().clear();
    if (!mapper.worth_using(moved) && !mapper.sees_push(rig_.features())) return;
    mapper.update(moved, rig_.features(), rig_.view());
  }
  void drive(double way_m, double turn_rad_per_m = 0.0) {
    const Pose2 step_by = {kStep_m, 0.0, turn_rad_per_m * kStep_m};
    for (double way = 0.0; way < way_m - 1e-9; way += kStep_m) step(step_by, step_by);
  }
  void cover(bool covered) { covered_ = covered; }
  void put_down(const Pose2& at) { truth_ = at; }

  const Pose2& truth() const { return truth_; }
  const Mapper& mapper() const { return rig_.mapper(); }
  double error_m() const {
    return (rig_.mapper().pose().mean.position() - truth_.position()).norm();
  }
  double error_rad() const {
    return std::abs(wrap_angle(rig_.mapper().pose().mean.theta_rad - truth_.theta_rad));
  }

 private:
  const PointWorld& world_;
  Random random_;
  bool covered_ = false;
  mutable MapperRig rig_;  // gives its mapper to callers that may change it alone
  Pose2 truth_;
};

PointWorld hall(std::uint64_t seed) {
  Random random(seed);
  return PointWorld::scatter(random, 1100, -8.0, 22.0, -9.0, 9.0);
}

struct Slip {
  double distance_m;
  double turn_deg;
  int frames;
};

TEST(MapperRecovery, WheelsThatSlipAreFollowedOrTold) {
  const TestSeed seed;
  int right = 0;
  int wrong = 0;
  int runs = 0;
  double worst_m = 0.0;
  for (const Slip slip :
       {Slip{0.1, 0.0, 3}, Slip{0.3, 0.0, 3}, Slip{0.5, 0.0, 20}, Slip{0.5, 0.0, 3},
        Slip{0.0, 5.0, 3}, Slip{0.05, 15.0, 3}, Slip{0.1, 40.0, 3}, Slip{0.1, 40.0, 20},
        Slip{0.0, -25.0, 5}, Slip{-0.2, -10.0, 4}}) {
    for (std::uint64_t run = 0; run < 2; ++run) {
      const PointWorld world = hall(seed.value() + run);
      auto robot = std::make_unique<Robot>(world, seed.value() + run);
      robot->drive(4.0);
      const double n = slip.frames;
      for (int i = 0; i < slip.frames; ++i) {
        robot->step({}, {slip.distance_m / n, 0.0, slip.turn_deg * kDegree / n});
      }
      robot->drive(3.0);
      ++runs;
      const bool tracks = robot->mapper().tracking() == TrackingState::kTracking;
      const bool fits = robot->error_m() < 0.06 && robot->error_rad() < 1.5 * kDegree;
      right += tracks && fits ? 1 : 0;
      wrong += tracks && !fits ? 1 : 0;
      if (tracks) worst_m = std::max(worst_m, robot->error_m());
    }
  }
  print_figure("mapper: %d of %d slips followed, error at most %.3f m", right, runs, worst_m);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 9 * runs / 10);
}

TEST(MapperRecovery, PushedAndTurnedWithLockedWheelsItIsFollowed) {
  const TestSeed seed;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const PointWorld world = hall(seed.value() + run);
    auto robot = std::make_unique<Robot>(world, seed.value() + run);
    robot->drive(4.0);
    const double turn = (run % 2 == 0 ? 3.0 : -2.0) * kDegree;
    for (int i = 0; i < 20; ++i) robot->step({0.04, 0.01, turn}, {});
    robot->drive(1.0);
    EXPECT_EQ(robot->mapper().tracking(), TrackingState::kTracking) << run;
    EXPECT_LT(robot->error_m(), 0.1) << run;
    EXPECT_LT(robot->error_rad(), 2.0 * kDegree) << run;
  }
}

TEST(MapperRecovery, LiftedAndPutDownInItsMapItIsFoundWithinThreeMetres) {
  const TestSeed seed;
  int found = 0;
  double longest_m = 0.0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const PointWorld world = hall(seed.value() + run);
    auto robot = std::make_unique<Robot>(world, seed.value() + run);
    robot->drive(14.0);
    robot->put_down({1.0 + 0.3 * static_cast<double>(run), 0.2, 0.5 * static_cast<double>(run)});
    double way_m = 0.0;
    robot->drive(0.2, 0.3);
    while (way_m < 3.0 && robot->mapper().tracking() != TrackingState::kTracking) {
      robot->drive(0.1, 0.3);
      way_m += 0.1;
    }
    longest_m = std::max(longest_m, way_m);
    if (robot->mapper().tracking() != TrackingState::kTracking) continue;
    ++found;
    EXPECT_LT(robot->error_m(), 0.15) << run;
    EXPECT_LT(robot->error_rad(), 3.0 * kDegree) << run;
  }
  print_figure("mapper: lifted, found again in %d of %d after at most %.1f m", found, kRuns,
               longest_m);
  EXPECT_GE(found, 9);
}

// A covered lens contradicts nothing: the wheels go on, and afterwards the map does.
TEST(MapperRecovery, CoveredLensLosesNobody) {
  const TestSeed seed;
  for (std::uint64_t run = 0; run < 3; ++run) {
    const PointWorld world = hall(seed.value() + run);
    auto robot = std::make_unique<Robot>(world, seed.value() + run);
    robot->drive(4.0);
    robot->cover(true);
    robot->drive(1.5);
    EXPECT_EQ(robot->mapper().tracking(), TrackingState::kTracking) << run;
    robot->cover(false);
    robot->drive(2.0);
    EXPECT_EQ(robot->mapper().tracking(), TrackingState::kTracking) << run;
    EXPECT_EQ(robot->mapper().counters().times_lost, 0u) << run;
    EXPECT_LT(robot->error_m(), 0.1) << run;
  }
}

// No map there: it says so, and keeps its map as it was. Brought back, it goes on in it.
TEST(MapperRecovery, WhereThereIsNoMapItIsLostAndTheMapStays) {
  const TestSeed seed;
  for (std::uint64_t run = 0; run < 3; ++run) {
    Random random(seed.value() + run);
    PointWorld world = hall(seed.value() + run);
    const PointWorld far = PointWorld::scatter(random, 800, 95.0, 115.0, -9.0, 9.0);
    world.landmarks.insert(world.landmarks.end(), far.landmarks.begin(), far.landmarks.end());
    auto robot = std::make_unique<Robot>(world, seed.value() + run);
    robot->drive(8.0);
    const std::uint64_t created = robot->mapper().counters().landmarks_created;
    robot->put_down({100.0, 0.0, 1.0});
    robot->drive(4.0);
    EXPECT_EQ(robot->mapper().tracking(), TrackingState::kLost) << run;
    EXPECT_EQ(robot->mapper().counters().times_lost, 1u) << run;
    EXPECT_EQ(robot->mapper().counters().landmarks_created, created) << run;
    robot->put_down({2.0, 0.0, 0.0});
    robot->drive(3.0);
    EXPECT_EQ(robot->mapper().tracking(), TrackingState::kTracking) << run;
    EXPECT_EQ(robot->mapper().counters().relocalised, 1u) << run;
    EXPECT_LT(robot->error_m(), 0.15) << run;
  }
}

}  // namespace
}  // namespace zenith
