#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/recording/layout.h"
#include "platform/recording/sensor_file.h"
#include "sim/simulation.h"
#include "tests/support/figure.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/calibrate/drive_calibration.h"
#include "tools/calibrate/drive_tracks.h"
#include "tools/calibrate/result_files.h"
#include "tools/runner/simulated_source.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kLatency_s = 0.030;  // of the world "calibration"

class CalibrateDrive : public testing::TestWithParam<std::uint64_t> {};

TEST_P(CalibrateDrive, FindsMountAndWheelsOfARenderedDrive) {
  auto team = simulate_team("calibration", GetParam(), 0.0, Parameters{});
  ASSERT_TRUE(team.ok()) << team.error().message;
  const auto data = track_drive(*team->sources[0], [](double) {});
  ASSERT_TRUE(data.ok()) << data.error().message;
  sim::SimOptions options;
  options.seed = GetParam();
  const auto simulation = sim::Simulation::load(sim::find_world("calibration"), options);
  ASSERT_TRUE(simulation.ok());
  const sim::RobotDrive drive = simulation->drive(0);
  const RobotConfig& truth = drive.truth();
  DriveReferences references;
  references.distance_m = (drive.T_world_robot({std::int64_t{3600} * 1'000'000'000}).position() -
                           drive.T_world_robot({0}).position())
                              .norm();
  const DriveCalibration c = calibrate_drive(*data, references);
  const CameraMount& m = c.robot.mount;
  const double yaw = std::abs(m.yaw_rad - truth.mount.yaw_rad) * kDegPerRad;
  const double tilt =
      std::hypot(m.roll_rad - truth.mount.roll_rad, m.pitch_rad - truth.mount.pitch_rad) *
      kDegPerRad;
  const double lever = std::hypot(m.x_m - truth.mount.x_m, m.y_m - truth.mount.y_m);
  const double track = std::abs(c.robot.wheels.track_width_m / truth.wheels.track_width_m - 1.0);
  const double wheel =
      std::max(std::abs(c.robot.wheels.left_scale / truth.wheels.left_scale - 1.0),
               std::abs(c.robot.wheels.right_scale / truth.wheels.right_scale - 1.0));
  const double latency = std::abs(c.latency_s - kLatency_s);
  print_figure(
      "drive with seed %d: yaw %.3f deg, tilt %.3f deg, lever arm %.1f mm, track width "
      "%.2f %%, wheel radius %.2f %%, latency %.1f ms",
      static_cast<int>(GetParam()), yaw, tilt, 1e3 * lever, 100.0 * track, 100.0 * wheel,
      1e3 * latency);
  EXPECT_LT(yaw, 0.2);
  EXPECT_LT(tilt, 0.15);
  EXPECT_LT(lever, 0.005);
  EXPECT_LT(track, 0.005);
  EXPECT_LT(wheel, 0.005);
  EXPECT_LT(latency, 0.006);
  // What was believed is wrong by more than that: nothing was just kept.
  EXPECT_GT(std::abs(data->believed.wheels.track_width_m / truth.wheels.track_width_m - 1.0),
            0.005);
  EXPECT_NE(c.judgement.worth, Worth::kAgain) << drive_report(c);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CalibrateDrive, testing::Values(1, 2));

TEST(CalibrateDriveFiles, MountAndWheelsGoIntoARecording) {
  TemporaryFolder folder;
  const auto rec = folder.path() / "rec";
  write_small_recording(rec);
  RobotConfig robot = small_robot();
  robot.mount.yaw_rad = 0.25;
  robot.wheels = {0.5, 1.01, 0.99};
  const Status written = write_robot(rec, {robot, 0.03, {}});
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto file = read_robot_file(layout::robot(rec));
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_DOUBLE_EQ(file->wheels.track_width_m, 0.5);
  EXPECT_DOUBLE_EQ(file->odometry.latency_s, 0.03);
  EXPECT_THAT(read_text(layout::robot(rec)), HasSubstr("# distance of the wheels' tracks"));
  const auto sensor = read_sensor_file(layout::sensor(rec));
  ASSERT_TRUE(sensor.ok()) << sensor.error().message;
  EXPECT_NEAR(sensor->mount.yaw_rad, 0.25, 1e-9);
}

// Straight on, with points straight above: no turn.
DriveData straight_drive() {
  DriveData data;
  for (int i = 0; i <= 60; ++i) data.wheels.add(0.1 * i, {0.1 * i, 0.1 * i});
  for (int i = 0; i < 50; ++i) {
    DriveFrame frame{0.1 * i, {}};
    for (int k = 0; k < 120; ++k) {
      const Eigen::Vector3d p(0.05 * k - 0.1 * i, 0.37 * (k % 7) - 1.1, 2.3 + 0.1 * (k % 3));
      if (std::abs(p.x()) < 1.5) frame.sightings.push_back({k, p.normalized()});
    }
    data.frames.push_back(frame);
  }
  data.tracks = 120;
  return data;
}

TEST(CalibrateDriveVerdict, WhatADriveDoesNotShowStaysAndTheVerdictSaysHowToDrive) {
  const DriveData data = straight_drive();
  const DriveCalibration c = calibrate_drive(data, {});
  EXPECT_NE(c.judgement.worth, Worth::kGood);
  const std::string text = judgement_text(c.judgement);
  EXPECT_THAT(text, HasSubstr("does not show wheels.track_width_m"));
  EXPECT_THAT(text, HasSubstr("turn on the spot more"));
  EXPECT_THAT(text, HasSubstr("--distance"));
  EXPECT_EQ(c.robot.wheels.track_width_m, data.believed.wheels.track_width_m);
  EXPECT_NEAR(c.robot.mount.yaw_rad, 0.0, 0.002);
}

// Straight ways and turns on the spot under a ceiling of points, by a camera at `lever_m`.
DriveData square_drive(const Eigen::Vector2d& lever_m) {
  DriveData data;
  const double half_track_m = 0.5 * data.believed.wheels.track_width_m;
  Pose2 pose;
  WheelTravel total;
  double time_s = 0.0;
  const auto see = [&] {
    data.wheels.add(time_s, total);
    DriveFrame frame{time_s, {}};
    for (int k = 0; k < 400; ++k) {
      const Eigen::Vector2d at(0.6 * (k % 20) - 4.5 + 0.11 * (k % 7),
                               0.6 * (k / 20) - 4.5 + 0.13 * (k % 5));
      const Eigen::Vector2d seen = pose.inverse() * at - lever_m;
      if (seen.norm() > 2.5) continue;
      frame.sightings.push_back(
          {k, Eigen::Vector3d(seen.x(), seen.y(), 2.2 + 0.1 * (k % 3)).normalized()});
    }
    data.frames.push_back(std::move(frame));
    time_s += 0.2;
  };
  for (int side = 0; side < 6; ++side) {
    for (int i = 0; i < 12; ++i) {
      see();
      pose = pose * Pose2{0.12, 0.0, 0.0};
      total = {total.left_m + 0.12, total.right_m + 0.12};
    }
    const double turn_rad = (side % 2 == 0 ? 10.0 : 11.0) / kDegPerRad;
    for (int i = 0; i < 9; ++i) {
      see();
      pose = pose * Pose2{0.0, 0.0, turn_rad};
      total = {total.left_m - turn_rad * half_track_m, total.right_m + turn_rad * half_track_m};
    }
  }
  data.tracks = 400;
  return data;
}

TEST(CalibrateDriveVerdict, ACameraOutsideOfTheRobotIsDoubtedAndNotTakenOver) {
  const DriveCalibration near = calibrate_drive(square_drive({0.3, -0.1}), {});
  EXPECT_NEAR(near.robot.mount.x_m, 0.3, 0.01);
  EXPECT_NEAR(near.robot.mount.y_m, -0.1, 0.01);
  EXPECT_THAT(judgement_text(near.judgement), testing::Not(HasSubstr("outside")));
  const DriveCalibration far = calibrate_drive(square_drive({0.9, -0.45}), {});
  EXPECT_EQ(far.robot.mount.x_m, 0.0);
  EXPECT_EQ(far.robot.mount.y_m, 0.0);
  const std::string text = judgement_text(far.judgement);
  EXPECT_THAT(text, HasSubstr("mount.x_m is doubtful: 0.9"));
  EXPECT_THAT(text, HasSubstr("mount.y_m is doubtful: -0.45"));
  EXPECT_THAT(text, HasSubstr("outside of a robot whose tracks are 0.40 m apart"));
  EXPECT_THAT(text, HasSubstr("turn on the spot more"));
  EXPECT_THAT(drive_report(far), HasSubstr("doubtful: stays as it was"));
}

TEST(CalibrateDriveFiles, LinesThatMendASetUpGoIntoTheConfiguration) {
  RobotResult result;
  result.latency_s = 0.75;
  result.wheels = WheelOrder{true, false, true};
  result.robot.mount.yaw_rad = std::numbers::pi / 2.0;
  const std::string lines = edited_toml("", robot_values(result));
  for (const char* line :
       {"[odometry]", "swap_wheels = true", "invert_left = false", "invert_right = true",
        "latency_s = 0.7500", "[mount]", "yaw_deg = 90.0000"}) {
    EXPECT_THAT(lines, HasSubstr(line));
  }
  EXPECT_EQ(lines.find("[odometry]"), lines.rfind("[odometry]")) << "no section twice";
  // A recording has the same in its two files, and can be read.
  TemporaryFolder folder;
  const auto rec = folder.path() / "rec";
  write_small_recording(rec);
  result.robot = small_robot();
  const Status written = write_robot(rec, result);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto file = read_robot_file(layout::robot(rec));
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_TRUE(file->odometry.swap_wheels && file->odometry.invert_right);
}

TEST(WheelOrders, AreDoneOneAfterTheOther) {
  const WheelTravel told = {1.0, 10.0};
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      const WheelOrder first = {(a & 1) != 0, (a & 2) != 0, (a & 4) != 0};
      const WheelOrder then = {(b & 1) != 0, (b & 2) != 0, (b & 4) != 0};
      const WheelTravel both = then.after(first).of(told);
      const WheelTravel each = then.of(first.of(told));
      EXPECT_EQ(both.left_m, each.left_m);
      EXPECT_EQ(both.right_m, each.right_m);
    }
  }
}

}  // namespace
}  // namespace zenith::tools
