#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "platform/daemon/config.h"
#include "platform/daemon/config_text.h"
#include "platform/recording/layout.h"
#include "platform/recording/pose_travel.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/sensor_file.h"
#include "tests/support/lenses.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/calibrate/detect.h"
#include "tools/calibrate/edit_toml.h"
#include "tools/calibrate/result_files.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

TEST(EditToml, ChangesValuesAndNothingElse) {
  const std::string text =
      "# mine\n[lens]\nfu_px = 150   # guessed\n# not fu_px = 3\n\n[mount]\nfu_px = 7\n";
  EXPECT_EQ(edited_toml(text, {{"lens.fu_px", "151.5"}, {"lens.k1", "0.1"}, {"wheels.a", "2"}}),
            "# mine\n[lens]\nfu_px = 151.5   # guessed\nk1 = 0.1\n# not fu_px = 3\n\n[mount]\n"
            "fu_px = 7\n\n[wheels]\na = 2\n");
}

TEST(EditToml, AFileThatItCannotEditStaysAsItWas) {
  TemporaryFolder folder;
  const auto path = folder.path() / "a.toml";
  const std::string inline_table = "lens = { fu_px = 1.0 }\n";
  write_text(path, inline_table);
  const Status edited = edit_toml_file(path, {{"lens.fu_px", "2.0"}});
  ASSERT_FALSE(edited.ok());
  EXPECT_EQ(read_text(path), inline_table);
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(ResultFiles, TheLensGoesIntoTheDaemonsConfiguration) {
  TemporaryFolder folder;
  const auto path = folder.path() / "zenith.toml";
  std::string text = annotated_config();
  text.replace(text.find("name = \"zenith\""), 15, "name = \"anna\"");
  write_text(path, text);
  const Lens lens{800, 600, 201.25, 202.5, 401.125, 299.5, {0.01, -0.02, 0.003, -0.0004}};
  const Status written = write_lens(path, lens);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto config = read_daemon_config(path);
  ASSERT_TRUE(config.ok()) << config.error().message;
  EXPECT_EQ(config->name, "anna");
  EXPECT_EQ(config->lens.width_px, 800);
  EXPECT_DOUBLE_EQ(config->lens.fu_px, 201.25);
  EXPECT_DOUBLE_EQ(config->lens.k[3], -0.0004);
  EXPECT_THAT(read_text(path), HasSubstr("# focal length along columns"));
}

// One after the other into one file: a model's keys do not stay behind for the next.
TEST(ResultFiles, LensesOfAllModelsGoIntoOneConfigurationAndBack) {
  TemporaryFolder folder;
  const auto path = folder.path() / "zenith.toml";
  write_text(path, annotated_config());
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const Status written = write_lens(path, lens);
    ASSERT_TRUE(written.ok()) << name << ": " << written.error().message;
    const auto config = read_daemon_config(path);
    ASSERT_TRUE(config.ok()) << name << ": " << config.error().message;
    EXPECT_TRUE(config->lens == lens) << name;
  }
  const std::string before = read_text(path);
  Lens bad = Lens{};
  bad.fu_px = -150.0;
  EXPECT_THAT(write_lens(path, bad).error().message, HasSubstr("fu_px is -150, expected 1 .."));
  EXPECT_EQ(read_text(path), before);
}

TEST(ResultFiles, TheLensOfARecordingLeavesItsMount) {
  TemporaryFolder folder;
  const auto rec = folder.path() / "rec";
  write_small_recording(rec);
  ASSERT_TRUE(is_recording(rec));
  const Lens lens{32, 24, 9.0, 9.0, 16.0, 12.0, {}};
  ASSERT_TRUE(write_lens(rec, lens).ok());
  const auto sensor = read_sensor_file(layout::sensor(rec));
  ASSERT_TRUE(sensor.ok()) << sensor.error().message;
  EXPECT_DOUBLE_EQ(sensor->lens.fu_px, 9.0);
  EXPECT_NEAR(sensor->mount.yaw_rad, small_robot().mount.yaw_rad, 1e-9);
}

// The track width that made the poses stays theirs: they tell the same travel, whatever is written.
TEST(ResultFiles, ANewTrackWidthDoesNotChangeWhatPosesTell) {
  TemporaryFolder folder;
  const auto rec = folder.path() / "rec";
  write_small_recording(rec);
  const double width_m = read_robot_file(layout::robot(rec))->wheels.track_width_m;
  RobotResult result;
  result.robot = small_robot();
  result.robot.wheels.track_width_m = 1.1 * width_m;
  ASSERT_TRUE(write_robot(rec, result).ok());
  EXPECT_EQ(read_robot_file(layout::robot(rec))->poses_track_width_m, 0.0);  // wheels of a CAN log

  const auto other = folder.path() / "other";
  write_small_recording(other);
  const auto poses = layout::odometry_tum(other);
  write_text(poses,
             "1 0 0 0 0 0 0 1\n1.1 0.05 0 0 0 0 0.05 0.99875\n1.2 0.1 0.01 0 0 0 0.1 0.995\n");
  const auto travel = [&] {
    const auto robot = read_robot_file(layout::robot(other));
    EXPECT_TRUE(robot.ok()) << robot.error().message;
    const auto log = read_pose_travel(poses, *robot);
    EXPECT_TRUE(log.ok()) << log.error().message;
    return log->samples;
  };
  const auto before = travel();
  for (const double factor : {1.1, 1.2}) {
    result.robot.wheels.track_width_m = factor * width_m;
    const Status written = write_robot(other, result);
    ASSERT_TRUE(written.ok()) << written.error().message;
    const auto robot = read_robot_file(layout::robot(other));
    EXPECT_NEAR(robot->wheels.track_width_m, factor * width_m, 1e-6);
    EXPECT_DOUBLE_EQ(robot->poses_track_width_m, width_m);
    const auto after = travel();
    ASSERT_EQ(after.size(), before.size());
    EXPECT_EQ(after.back().left_m, before.back().left_m);
    EXPECT_EQ(after.back().right_m, before.back().right_m);
  }
}

TEST(Target, WhatIsPrintedIsFoundAndIsTrueToSize) {
  TemporaryFolder folder;
  for (const char* kind : {"checkerboard", "charuco"}) {
    const auto target = parse_target(kind, "9x6", 30.0);
    ASSERT_TRUE(target.ok());
    const auto path = folder.path() / (std::string(kind) + ".png");
    ASSERT_TRUE(write_target(*target, path).ok());
    const cv::Mat page = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
    cv::Mat seen;  // as by a camera: every third dot
    cv::resize(page, seen, {}, 1.0 / 3.0, 1.0 / 3.0, cv::INTER_AREA);
    const auto found = detect_target(seen, *target);
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_EQ(found->ids.size(), 40u);
    // Dots per metre stand in the file, big-endian, behind "pHYs".
    const std::string bytes = read_text(path);
    const std::size_t at = bytes.find("pHYs") + 4;
    double dots = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      dots = 256.0 * dots + static_cast<std::uint8_t>(bytes[at + i]);
    const double across_px = (found->corners_px[1] - found->corners_px[0]).norm() * 3.0;
    EXPECT_NEAR(across_px / dots, 0.030, 2e-4) << kind;
  }
}

TEST(Target, APdfTellsItsSize) {
  TemporaryFolder folder;
  const auto path = folder.path() / "board.pdf";
  ASSERT_TRUE(write_target(Target{}, path).ok());
  const std::string text = read_text(path);
  // 9 x 30 mm and two margins of 12 mm: 294 mm are 833.386 points.
  EXPECT_THAT(text, HasSubstr("/MediaBox [0 0 833.386 578.268]"));
  EXPECT_FALSE(write_target(Target{}, folder.path() / "board.doc").ok());
}

TEST(Target, WrongOnesAreRefusedWithReasons) {
  EXPECT_THAT(parse_target("dots", "9x6", 30).error().message, HasSubstr("'dots'"));
  EXPECT_THAT(parse_target("charuco", "9-6", 30).error().message, HasSubstr("'9-6'"));
  EXPECT_THAT(parse_target("charuco", "20x20", 30).error().message, HasSubstr("at most 50"));
  EXPECT_THAT(parse_target("checkerboard", "9x2", 30).error().message, HasSubstr("4 to 30"));
}

}  // namespace
}  // namespace zenith::tools
