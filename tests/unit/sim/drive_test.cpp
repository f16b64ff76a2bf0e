// Motion, odometry and determinism of the robots' drives.

#include <cmath>

#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/wheel_decoder.h"
#include "sim/seed.h"
#include "sim/simulation.h"
#include "sim/world.h"
#include "slam/filter/motion.h"
#include "tests/unit/sim/test_world.h"

namespace zenith::sim {
namespace {

// Run without pictures: what follows from the world file and a seed alone.
struct Plan {
  WorldFile file;
  FloorPlan plan;
  std::vector<Run> runs;
};

Plan plan_world(const std::string& name, std::uint64_t seed) {
  Plan out;
  out.file = load_world_file(find_world(name)).value();
  out.plan = FloorPlan::build(out.file).value();
  for (std::size_t i = 0; i < out.file.robots.size(); ++i) {
    auto run = plan_run(out.file, out.plan, i, mix_seed(seed, "world", out.file.seed), {});
    EXPECT_TRUE(run.ok()) << run.error().message;
    if (run.ok()) out.runs.push_back(std::move(*run));
  }
  return out;
}

TEST(Drive, WaysStayFreeOfWallsInAllWorldsAndSeeds) {
  for (const std::string& name : list_worlds()) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Plan world = plan_world(name, seed);
      ASSERT_EQ(world.runs.size(), world.file.robots.size()) << name << " seed " << seed;
      for (const auto& run : world.runs) {
        for (double t = 0.0; t < run.duration_s; t += 0.02) {
          ASSERT_TRUE(world.plan.is_free(run.path.at(t).pose.position(), 0.22))
              << name << " seed " << seed << " at " << t << " s";
        }
        const Eigen::Vector2d end = run.path.at(run.duration_s).pose.position();
        EXPECT_LT((end - run.waypoints.back()).norm(), 0.15) << name << " seed " << seed;
        EXPECT_GT(run.duration_s, 25.0) << name;
        EXPECT_LT(run.duration_s, 230.0) << name;
      }
    }
  }
}

TEST(Drive, KeepsToLimitsOfSpeedAndAcceleration) {
  DriveLimits limits;
  for (const std::string& name : list_worlds()) {
    const Plan world = plan_world(name, 4);
    for (std::size_t i = 0; i < world.runs.size(); ++i) {
      const auto& run = world.runs[i];
      limits.speed_mps = world.file.robots[i].speed_mps;
      constexpr double kStep = DrivenPath::kStep_s;
      for (double t = kStep; t < run.duration_s; t += kStep) {
        const DriveState a = run.path.at(t - kStep);
        const DriveState b = run.path.at(t);
        ASSERT_LE(b.speed_mps, limits.speed_mps + 1e-9);
        ASSERT_GE(b.speed_mps, -1e-9);
        ASSERT_LE(std::abs(b.turn_radps), limits.turn_radps + 1e-9);
        ASSERT_LE(std::abs(b.speed_mps - a.speed_mps), limits.acceleration_mps2 * kStep + 1e-9);
        ASSERT_LE(std::abs(b.turn_radps - a.turn_radps),
                  limits.turn_acceleration_radps2 * kStep + 1e-9);
      }
    }
  }
}

TEST(Drive, SeedsDiffer) {
  const Plan a = plan_world("corridor-rooms", 1);
  const Plan b = plan_world("corridor-rooms", 2);
  EXPECT_GT((a.runs[0].waypoints[3] - b.runs[0].waypoints[3]).norm(), 0.005);
  EXPECT_NE(a.runs[0].truth.lens.cu_px, b.runs[0].truth.lens.cu_px);
  EXPECT_NE(a.runs[0].wheel_errors.left_scale, b.runs[0].wheel_errors.left_scale);
}

TEST(Drive, SameSeedSameBytes) {
  const auto run = [] {
    auto simulation =
        Simulation::load(find_world("corridor-rooms"), {.seed = 9, .max_view_angle_deg = 50.0});
    RobotDrive drive = simulation->drive(1);
    std::vector<std::uint8_t> pixels;
    std::vector<CanFrame> bus;
    SimFrame frame;
    std::vector<CanFrame> can;
    for (int i = 0; i < 25 && drive.next(frame, can); ++i) {
      pixels.insert(pixels.end(), frame.pixels.begin(), frame.pixels.end());
      bus.insert(bus.end(), can.begin(), can.end());
    }
    return std::pair(pixels, bus);
  };
  const auto a = run();
  const auto b = run();
  EXPECT_TRUE(a.first == b.first);
  ASSERT_EQ(a.second.size(), b.second.size());
  for (std::size_t i = 0; i < a.second.size(); ++i) {
    ASSERT_EQ(a.second[i].stamp, b.second[i].stamp);
    ASSERT_EQ(a.second[i].data, b.second[i].data);
  }
}

TEST(Drive, FramesAndBusComeInStep) {
  auto simulation = Simulation::load(find_world("heights"), {.max_view_angle_deg = 20.0});
  ASSERT_TRUE(simulation.ok());
  RobotDrive drive = simulation->drive(0);
  SimFrame frame;
  std::vector<CanFrame> can;
  Time last_stamp;
  Time last_can;
  int frames = 0;
  while (drive.next(frame, can)) {
    ASSERT_FALSE(can.empty());
    ASSERT_GT(frame.stamp, last_stamp);
    for (const CanFrame& next : can) {
      ASSERT_GT(next.stamp, last_can);
      last_can = next.stamp;
    }
    ASSERT_EQ(can.back().id, agilex_v2::kOdometerId);
    ASSERT_GE(can.back().stamp, frame.stamp);
    if (frames == 0) {
      EXPECT_LT(can.front().stamp, frame.stamp);
    } else {
      EXPECT_EQ((frame.stamp - last_stamp).ns, 100'000'000);
    }
    last_stamp = frame.stamp;
    ++frames;
  }
  EXPECT_EQ(frames, drive.frame_count());
}

struct Ends {
  Pose2 odometry;
  Pose2 truth;
  double travelled_m = 0.0;
  double reported_at_rest_m = 0.0;
};

// Dead reckoning over a whole run with the believed wheels.
Ends dead_reckoning(const Plan& world, std::size_t robot, std::uint64_t seed) {
  const Run& run = world.runs[robot];
  Random random(seed, robot);
  const auto bus = drive_wheels(run.path, run.duration_s, Time{kFirstStamp_ns}, world.file.wheels,
                                run.wheel_errors, random);
  WheelDecoder decoder;
  Ends ends;
  const Pose2 start = run.path.at(0.0).pose;
  std::optional<WheelSample> last;
  for (const CanFrame& frame : bus) {
    const auto sample = decoder.decode(frame);
    if (!sample) continue;
    if (last) {
      const WheelTravel step = {sample->left_m - last->left_m, sample->right_m - last->right_m};
      ends.odometry = ends.odometry * wheel_motion(run.believed.wheels, step);
      ends.travelled_m += 0.5 * std::abs(step.left_m + step.right_m);
      if (sample->stamp < Time{kFirstStamp_ns + 900'000'000}) {
        ends.reported_at_rest_m += std::abs(step.left_m) + std::abs(step.right_m);
      }
    }
    last = sample;
  }
  EXPECT_EQ(decoder.counters().resets, 0u);
  ends.truth = start.inverse() * run.path.at(run.duration_s).pose;
  return ends;
}

TEST(Odometry, NoMotionWhileStanding) {
  const Plan world = plan_world("corridor-rooms", 1);
  EXPECT_EQ(dead_reckoning(world, 0, 1).reported_at_rest_m, 0.0);
  EXPECT_EQ(dead_reckoning(world, 1, 1).reported_at_rest_m, 0.0);
}

// 60 runs of about 30 m: the error of dead reckoning is what cheap wheels have, neither nothing
// nor nonsense. Wheels that differ by 1 % bend a straight corridor into an arc.
TEST(Odometry, ErrorOfDeadReckoningIsRealistic) {
  double sum_position = 0.0;
  double sum_heading2 = 0.0;
  int runs = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Plan world = plan_world("corridor-rooms", seed);
    const Ends ends = dead_reckoning(world, 1, seed);
    const double position = (ends.odometry.position() - ends.truth.position()).norm();
    const double heading = wrap_angle(ends.odometry.theta_rad - ends.truth.theta_rad);
    EXPECT_LT(position, 0.8 * ends.travelled_m);
    sum_position += position;
    sum_heading2 += heading * heading;
    ++runs;
  }
  // Heading: a difference of 0.01 over 30 m / 0.4 m is 0.75 rad; track width, slip and drift change
  // it by less than a tenth. The standard error of a deviation from 60 samples is 9 %: the band is
  // four of them to each side.
  const double heading_sigma = std::sqrt(sum_heading2 / runs);
  EXPECT_GT(heading_sigma, 0.45);
  EXPECT_LT(heading_sigma, 1.05);
  EXPECT_GT(sum_position / runs, 0.5);
  EXPECT_LT(sum_position / runs, 8.0);
}

// Without errors, dead reckoning is the truth up to the millimetre steps: 0.5 mm of rounding error
// at each end of each wheel turn into at most 5 mrad and, over 21 m, a few centimetres.
TEST(Odometry, PerfectWheelsReckonTheTruth) {
  Plan world = plan_world("corridor-rooms", 2);
  world.file.wheels = {.track_width_m = 0.4,
                       .scale_sigma = 0.0,
                       .unequal_sigma = 0.0,
                       .track_sigma = 0.0,
                       .slip_sigma_per_sqrt_m = 0.0,
                       .drift_sigma = 0.0,
                       .slip_events_per_m = 0.0};
  for (auto& run : world.runs) run.wheel_errors = {};
  for (std::size_t robot = 0; robot < 2; ++robot) {
    const Ends ends = dead_reckoning(world, robot, 1);
    EXPECT_LT((ends.odometry.position() - ends.truth.position()).norm(), 0.06);
    EXPECT_NEAR(wrap_angle(ends.odometry.theta_rad - ends.truth.theta_rad), 0.0, 0.006);
  }
}

}  // namespace
}  // namespace zenith::sim
