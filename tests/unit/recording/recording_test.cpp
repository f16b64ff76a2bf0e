#include "platform/recording/recording.h"

#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/config/lens_settings.h"
#include "platform/recording/layout.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/sensor_file.h"
#include "slam/image/lens_projection.h"
#include "tests/support/lenses.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RecordingTest : public testing::Test {
 protected:
  void SetUp() override { write_small_recording(folder_); }

  // Opens and reads to the end; the message of the first error, or "".
  std::string read_all(const ReadOptions& options = {}) {
    auto recording = Recording::open(folder_, options);
    if (!recording.ok()) return recording.error().message;
    SourceFrame frame;
    for (frames_ = 0;; ++frames_) {
      const auto more = (*recording)->next(frame);
      if (!more.ok()) return more.error().message;
      if (!*more) break;
    }
    warnings_ = (*recording)->warnings();
    return "";
  }

  fs::path frame_file(int i) const {
    return layout::frames(folder_) / (std::to_string(small_stamp(i).ns) + ".png");
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "ada";
  int frames_ = 0;
  std::vector<std::string> warnings_;
};

TEST_F(RecordingTest, ComesBackAsItWasWritten) {
  auto recording = Recording::open(folder_.string() + "/", {});
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ((*recording)->name(), "ada");
  EXPECT_EQ((*recording)->frame_count(), 10);
  const RobotConfig& got = (*recording)->config();
  const RobotConfig put = small_robot();
  EXPECT_EQ(got.lens.width_px, put.lens.width_px);
  EXPECT_EQ(got.lens.height_px, put.lens.height_px);
  EXPECT_NEAR(got.lens.fu_px, put.lens.fu_px, 1e-9);
  EXPECT_NEAR(got.lens.fv_px, put.lens.fv_px, 1e-9);
  EXPECT_NEAR(got.lens.cu_px, put.lens.cu_px, 1e-9);
  EXPECT_NEAR(got.lens.cv_px, put.lens.cv_px, 1e-9);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(got.lens.k[i], put.lens.k[i], 1e-12);
  EXPECT_NEAR(got.mount.x_m, put.mount.x_m, 1e-9);
  EXPECT_NEAR(got.mount.y_m, put.mount.y_m, 1e-9);
  EXPECT_NEAR(got.mount.z_m, put.mount.z_m, 1e-9);
  EXPECT_NEAR(got.mount.roll_rad, put.mount.roll_rad, 1e-9);
  EXPECT_NEAR(got.mount.pitch_rad, put.mount.pitch_rad, 1e-9);
  EXPECT_NEAR(got.mount.yaw_rad, put.mount.yaw_rad, 1e-9);
  EXPECT_NEAR(got.wheels.track_width_m, put.wheels.track_width_m, 1e-9);
  EXPECT_NEAR(got.wheels.left_scale, put.wheels.left_scale, 1e-9);
  EXPECT_NEAR(got.wheels.right_scale, put.wheels.right_scale, 1e-9);
  EXPECT_NEAR(got.frame_rate_hz, put.frame_rate_hz, 1e-9);
}

TEST_F(RecordingTest, AnEditorsMarkInItsFilesIsPassedOver) {
  for (const fs::path& file :
       {layout::robot(folder_), layout::sensor(folder_), layout::frame_list(folder_),
        layout::ground_truth(folder_), layout::can_log(folder_, RobotFile().can_interface)}) {
    ASSERT_TRUE(fs::exists(file)) << file;
    write_text(file, "\xef\xbb\xbf" + read_text(file));
  }
  EXPECT_EQ(read_all(), "");
  EXPECT_EQ(frames_, 10);
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(RecordingTest, DeliversFramesWithTheirWheelsAndTruth) {
  auto recording = Recording::open(folder_, {});
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  SourceFrame frame;
  Time last{};
  for (int i = 0; i < 10; ++i) {
    const auto more = (*recording)->next(frame);
    ASSERT_TRUE(more.ok() && *more) << i;
    EXPECT_EQ(frame.stamp, small_stamp(i));
    EXPECT_EQ(frame.pixels, small_pixels(i));
    ASSERT_TRUE(frame.truth.has_value());
    EXPECT_NEAR(frame.truth->x_m, small_pose(i).x_m, 1e-6);
    EXPECT_NEAR(frame.truth->y_m, small_pose(i).y_m, 1e-6);
    EXPECT_NEAR(wrap_angle(frame.truth->theta_rad - small_pose(i).theta_rad), 0.0, 1e-6);
    ASSERT_FALSE(frame.wheels.empty());
    EXPECT_GE(frame.wheels.back().stamp, frame.stamp);
    for (const WheelSample& sample : frame.wheels) {
      EXPECT_GT(sample.stamp, last);
      last = sample.stamp;
    }
  }
  const auto end = (*recording)->next(frame);
  ASSERT_TRUE(end.ok());
  EXPECT_FALSE(*end);
  EXPECT_THAT((*recording)->warnings(), IsEmpty());
}

TEST_F(RecordingTest, TellsWhatIsMissing) {
  EXPECT_THAT(Recording::open(temporary_.path() / "none", {}).error().message,
              HasSubstr("no such folder"));
  for (const fs::path& path : {layout::robot(folder_), layout::sensor(folder_),
                               layout::frame_list(folder_), layout::can_log(folder_, "can0")}) {
    const std::string text = read_text(path);
    fs::remove(path);
    EXPECT_THAT(read_all(), AllOf(HasSubstr(path.string()), HasSubstr("missing")));
    write_text(path, text);
  }
  EXPECT_EQ(read_all(), "");
}

TEST_F(RecordingTest, NamesTheLineOfAMissingFrame) {
  fs::remove(frame_file(3));
  fs::remove(frame_file(5));
  EXPECT_THAT(read_all(), AllOf(HasSubstr("data.csv:5: the frame "), HasSubstr("1 more")));
  ReadOptions options;
  options.skip_damaged = true;
  EXPECT_EQ(read_all(options), "");
  EXPECT_EQ(frames_, 8);
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_THAT(warnings_[0], HasSubstr("2 of 10 frames left out"));
}

TEST_F(RecordingTest, NamesADamagedFrame) {
  const std::string whole = read_text(frame_file(4));
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{20}, whole.size() / 2, whole.size() - 20}) {
    write_text(frame_file(4), whole.substr(0, size));
    EXPECT_THAT(read_all(), AllOf(HasSubstr("data.csv:6: "), HasSubstr("truncated PNG"))) << size;
  }
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 0x10);
  write_text(frame_file(4), flipped);
  EXPECT_THAT(read_all(), HasSubstr("damaged"));
}

TEST_F(RecordingTest, RefusesAFrameOfAnotherSize) {
  edit_text(layout::sensor(folder_), "resolution: [32, 24]", "resolution: [32, 25]");
  EXPECT_THAT(read_all(), AllOf(HasSubstr("is 32 x 24"), HasSubstr("says 32 x 25")));
}

TEST_F(RecordingTest, RefusesStampsThatDoNotRise) {
  const std::string second = std::to_string(small_stamp(1).ns);
  edit_text(layout::frame_list(folder_), second + "," + second,
            std::to_string(small_stamp(0).ns) + "," + second);
  EXPECT_THAT(read_all(), AllOf(HasSubstr("data.csv:3: "), HasSubstr("does not follow")));
}

TEST_F(RecordingTest, RefusesMalformedFrameLists) {
  for (const char* line : {"abc,1.png", "12", "12,", "-5,1.png", "12,../1.png", "12,a/b.png",
                           "99999999999999999999,1.png", "12,1.png,3"}) {
    write_text(layout::frame_list(folder_),
               "#timestamp [ns],filename\n" + std::string(line) + "\n");
    EXPECT_THAT(read_all(), HasSubstr("data.csv:2: expected 'nanoseconds,filename'")) << line;
  }
  write_text(layout::frame_list(folder_), "#timestamp [ns],filename\n");
  EXPECT_THAT(read_all(), HasSubstr("lists no frame"));
}

TEST_F(RecordingTest, CountsGapsOfTheOdometry) {
  std::string log;
  for (const int i : {0, 1, 2, 40, 41, 60}) {
    const Time stamp{1'000'000'000 + i * 20'000'000LL};
    log += "(000000000" + std::to_string(stamp.ns / 1'000'000'000) + "." +
           std::to_string(stamp.ns % 1'000'000'000 / 1000 + 1'000'000).substr(1) +
           ") can0 311#0000000000000000\n";
  }
  write_text(layout::can_log(folder_, "can0"), log);
  EXPECT_EQ(read_all(), "");
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_THAT(warnings_[0], AllOf(HasSubstr("1 gap "), HasSubstr("0.76 s after 1.04")));
  ReadOptions options;
  options.max_odometry_gap_s = 0.8;
  EXPECT_EQ(read_all(options), "");
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(RecordingTest, CountsOddLinesOfTheLog) {
  const fs::path log = layout::can_log(folder_, "can0");
  const std::string good = read_text(log);
  write_text(log, good.substr(0, good.find('\n') + 1) + "garbage\n(1.0) can1 311#00\n" +
                      "(1.001) can0 123#00\n(1.002) can0 123#00\n(1.003) can0 7A#R\n(1.0) can0 31" +
                      "\n" + good.substr(good.find('\n') + 1) + "(2.3) can0 311#0000\n(2.2");
  EXPECT_EQ(read_all(), "");
  EXPECT_THAT(
      warnings_,
      ElementsAre(AllOf(HasSubstr("can0.log:2: malformed line"), HasSubstr("found 'garbage'"),
                        HasSubstr("3 more")),
                  AllOf(HasSubstr("1 frames of other interfaces"), HasSubstr("expected can0")),
                  HasSubstr("2 frames with identifiers that the codec does not know: 123 (2)"),
                  HasSubstr("1 odometry frames that are too short")));
}

TEST_F(RecordingTest, RefusesALogThatHoldsNoTravel) {
  write_text(layout::can_log(folder_, "can0"), "(1.0) can0 123#00\nnonsense\n");
  EXPECT_THAT(read_all(), AllOf(HasSubstr("holds no odometry"), HasSubstr("can0.log:2: malformed"),
                                HasSubstr("123 (1)")));
  write_text(
      layout::can_log(folder_, "can0"),
      "(1436509052.0) can0 311#0000000000000000\n(1436509053.0) can0 311#0000000000000000\n");
  EXPECT_THAT(read_all(), HasSubstr("no time in common"));
}

// The bus has the right number with the other length: named as such, with what was expected.
TEST_F(RecordingTest, NamesIdentifiersOfTheOtherLength) {
  std::string log = read_text(layout::can_log(folder_, "can0"));
  for (std::size_t at = 0; (at = log.find(" 311#", at)) != std::string::npos; ++at) {
    log.replace(at, 5, " 00000311#");
  }
  write_text(layout::can_log(folder_, "can0"), log);
  EXPECT_THAT(read_all(),
              AllOf(HasSubstr("holds no odometry"),
                    HasSubstr("does not know: 00000311 (61); it expects 311"),
                    HasSubstr("61 frames of 00000311, a 29-bit identifier; the codec expects 11")));
}

TEST_F(RecordingTest, WheelsThatCannotBeWheelsAreAnError) {
  // The same drive, its counters' bytes the other way round.
  std::string log;
  for (int i = 0; i <= 60; ++i) {
    char line[80];
    std::snprintf(line, sizeof line, "(000000000%d.%06d) can0 311#%02X%02X0000%02X%02X0000\n",
                  1 + i / 50, i % 50 * 20'000, 10 * i & 0xFF, 10 * i >> 8, 11 * i & 0xFF,
                  11 * i >> 8);
    log += line;
  }
  write_text(layout::can_log(folder_, "can0"), log);
  EXPECT_THAT(read_all(),
              AllOf(HasSubstr("can0.log: the wheels are read wrong"), HasSubstr("byte order")));
}

TEST_F(RecordingTest, RefusesBadRobots) {
  const fs::path file = layout::robot(folder_);
  const std::string good = read_text(file);
  const auto broken = [&](const std::string& from, const std::string& to) {
    write_text(file, good);
    edit_text(file, from, to);
    return read_all();
  };
  EXPECT_THAT(broken("left_scale", "left_scael"),
              AllOf(HasSubstr("robot.toml:6: unknown key wheels.left_scael; did you mean "
                              "wheels.left_scale?"),
                    HasSubstr("missing key wheels.left_scale")));
  EXPECT_THAT(broken("track_width_m = 0.437000000", "track_width_m = nan"),
              HasSubstr("robot.toml:5: wheels.track_width_m is nan"));
  EXPECT_THAT(broken("track_width_m = 0.437000000", "track_width_m = \"wide\""),
              HasSubstr("robot.toml:5: wheels.track_width_m is no number"));
  EXPECT_THAT(broken("track_width_m = 0.437000000", "track_width_m = -1.0"),
              HasSubstr("expected 0.02 .. 5"));
  EXPECT_THAT(broken("agilex_v2", "agilex_v9"),
              HasSubstr("'agilex_v9' is unknown; known: agilex_v2"));
  EXPECT_THAT(broken("[wheels]", "[wheels"), HasSubstr("robot.toml:4: "));
  EXPECT_THAT(broken("[odometry]", "[odo]"), HasSubstr("unknown key odo"));
  EXPECT_THAT(broken("can_interface = \"can0\"", "can_interface = \"../can0\""),
              HasSubstr("no interface's name"));
}

TEST_F(RecordingTest, RefusesBadCalibrations) {
  const fs::path file = layout::sensor(folder_);
  const std::string good = read_text(file);
  const auto broken = [&](const std::string& from, const std::string& to) {
    write_text(file, good);
    edit_text(file, from, to);
    return read_all();
  };
  EXPECT_THAT(broken("intrinsics: [9.5", "intrinsics: [.nan"),
              AllOf(HasSubstr("sensor.yaml:15: intrinsics holds .nan"), HasSubstr("finite")));
  EXPECT_THAT(broken("intrinsics: [9.5", "intrinsics: [.inf"), HasSubstr("finite"));
  EXPECT_THAT(broken("intrinsics: [9.5, ", "intrinsics: ["), HasSubstr("3 numbers, expected 4"));
  EXPECT_THAT(broken("intrinsics", "intrinsicks"), HasSubstr("missing key intrinsics"));
  EXPECT_THAT(broken("T_BS", "T_SB"), HasSubstr("missing key T_BS"));
  EXPECT_THAT(broken("0, 0, 0, 1]", "0, 0, 0, 2]"), HasSubstr("no rigid transform"));
  EXPECT_THAT(broken("model: equidistant", "model: magic"),
              HasSubstr("distortion_model magic is unknown"));
  EXPECT_THAT(broken("coefficients: [0.01", "coefficients: [-2"), HasSubstr("fold"));
  EXPECT_THAT(broken("rate_hz: 10", "rate_hz: fast"), HasSubstr("rate_hz is no number"));
  EXPECT_THAT(broken("resolution: [", "resolution: {"), HasSubstr("sensor.yaml:"));
  EXPECT_THAT(broken("[32, 24]", "[32, -24]"), HasSubstr("resolution (height)"));
  write_text(file, "- a\n- list\n");
  EXPECT_THAT(read_all(), HasSubstr("expected keys and values"));
  write_text(file, "");
  EXPECT_THAT(read_all(), HasSubstr("sensor.yaml"));
}

TEST_F(RecordingTest, RefusesBadGroundTruthAndDoesWithout) {
  const fs::path file = layout::ground_truth(folder_);
  write_text(file, "# header\n1.0 0 0 0 0 0 0 1\n1.1 0 0 0 0 0 nan 1\n");
  EXPECT_THAT(read_all(), HasSubstr("groundtruth.tum:3: expected"));
  write_text(file, "1.0 0 0 0 0 0 0 1\n1.0 0 0 0 0 0 0 1\n");
  EXPECT_THAT(read_all(), HasSubstr("groundtruth.tum:2: the stamp"));
  fs::remove(file);
  EXPECT_EQ(read_all(), "");
}

TEST_F(RecordingTest, SurvivesAnyDamage) {
  // Every file cut at many places, and filled with noise: an error or a result, never a crash.
  for (const fs::path& path :
       {layout::robot(folder_), layout::sensor(folder_), layout::frame_list(folder_),
        layout::can_log(folder_, "can0"), layout::ground_truth(folder_), frame_file(2)}) {
    const std::string good = read_text(path);
    for (std::size_t cut = 0; cut < good.size(); cut += 1 + good.size() / 40) {
      write_text(path, good.substr(0, cut));
      read_all();
      std::string noisy = good;
      noisy[cut] = static_cast<char>(noisy[cut] ^ (1 + cut % 255));
      write_text(path, noisy);
      read_all();
    }
    write_text(path, good);
  }
  EXPECT_EQ(read_all(), "");
}

std::string sensor_text(const std::string& lens) {
  return "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.3, 0, 0, 0, 1]\nrate_hz: 10\n"
         "resolution: [640, 480]\n" +
         lens;
}

TEST(SensorFile, LensesOfAllModelsComeBack) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    SensorFile sensor;
    sensor.lens = lens;
    const auto back = parse_sensor_file(format_sensor_file(sensor), "sensor.yaml");
    ASSERT_TRUE(back.ok()) << name << ": " << back.error().message;
    EXPECT_EQ(back->lens.model, lens.model) << name;
    // Twelve digits are written.
    const LensProjection a(lens);
    const LensProjection b(back->lens);
    for (const Eigen::Vector3d& ray :
         {Eigen::Vector3d(0.1, 0.2, 1.0), Eigen::Vector3d(-0.5, 0.1, 1.0)}) {
      EXPECT_LT((*a.project(ray) - *b.project(ray)).norm(), 1e-8) << name;
    }
  }
}

TEST(SensorFile, AnEquidistantLensIsWrittenAsEver) {
  SensorFile sensor;
  sensor.lens.k = {-0.012, 0.004, -0.0015, 0.0001};
  EXPECT_THAT(format_sensor_file(sensor),
              HasSubstr("resolution: [640, 480]\n"
                        "camera_model: pinhole\n"
                        "intrinsics: [150, 150, 320, 240]  # fu, fv, cu, cv\n"
                        "distortion_model: equidistant  # Kannala and Brandt, k1 .. k4\n"
                        "distortion_coefficients: [-0.012, 0.004, -0.0015, 0.0001]\n"));
}

TEST(SensorFile, ModelsAreReadInTheWordsOfOthers) {
  const auto model_of = [](const std::string& lens) {
    const auto sensor = parse_sensor_file(sensor_text(lens), "s");
    return sensor.ok() ? std::string(lens_model_name(sensor->lens.model)) : sensor.error().message;
  };
  const std::string plain = "intrinsics: [400, 400, 320, 240]\n";
  EXPECT_EQ(model_of(plain + "distortion_coefficients: [0, 0, 0, 0]\n"), "equidistant");
  EXPECT_EQ(model_of(plain + "camera_model: pinhole\ndistortion_model: plumb_bob\n"
                             "distortion_coefficients: [-0.1, 0, 0, 0]\n"),
            "radtan");
  EXPECT_EQ(model_of(plain + "distortion_model: radtan\ndistortion_coefficients: "
                             "[-0.1, 0, 0, 0, 0.01]\n"),
            "radtan");
  EXPECT_EQ(model_of(plain + "distortion_model: none\n"), "radtan");
  EXPECT_EQ(model_of(plain + "distortion_model: rational_polynomial\ndistortion_coefficients: "
                             "[0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0, 0, 0, 0]\n"),
            "rational");
  EXPECT_EQ(model_of("camera_model: omni\nintrinsics: [0.9, 400, 400, 320, 240]\n"), "omni");
}

TEST(SensorFile, WhatNoLensIsIsRefusedWithItsLine) {
  const auto refusal = [](const std::string& lens) {
    const auto sensor = parse_sensor_file(sensor_text(lens), "s");
    return sensor.ok() ? "" : sensor.error().message;
  };
  const std::string zeros = "distortion_coefficients: [0, 0, 0, 0]\n";
  EXPECT_THAT(refusal("intrinsics: [-150, 150, 320, 240]\n" + zeros),
              HasSubstr("s:5: intrinsics (fu) is -150, expected 1 .. 100000"));
  EXPECT_THAT(refusal("intrinsics: [150, 150, 640, 240]\n" + zeros),
              HasSubstr("s:5: intrinsics (cu) lies outside of the frame"));
  EXPECT_THAT(refusal("intrinsics: [150, 150, 320, .nan]\n" + zeros), HasSubstr("s:5: intrinsics"));
  EXPECT_THAT(refusal("intrinsics: [150, 150, 320, 240]\ndistortion_coefficients: [-2, 0, 0, 0]\n"),
              HasSubstr("s:6: distortion_coefficients (k1) and the other numbers (k1 k2 k3 k4) "
                        "fold the image over itself"));
  EXPECT_THAT(refusal("camera_model: ds\nintrinsics: [0.1, 3, 150, 150, 320, 240]\n"),
              HasSubstr("s:6: intrinsics (alpha) is 3, expected 0 .. 1"));
  EXPECT_THAT(refusal("camera_model: ds\ndistortion_model: radtan\n"),
              HasSubstr("s:6: camera_model ds with distortion_model radtan is unknown; known: "));
  EXPECT_THAT(refusal("intrinsics: [150, 150, 320, 240]\ndistortion_model: rational_polynomial\n"
                      "distortion_coefficients: [0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0]\n"),
              HasSubstr("s:7: distortion_coefficients: thin prism and tilt"));
}

TEST(Mount, MatrixAndAnglesAgree) {
  const CameraMount mount{0.1, 0.2, 0.3, 0.11, -0.22, 2.5};
  const CameraMount back = mount_of_matrix(mount_matrix(mount));
  EXPECT_NEAR(back.roll_rad, mount.roll_rad, 1e-12);
  EXPECT_NEAR(back.pitch_rad, mount.pitch_rad, 1e-12);
  EXPECT_NEAR(back.yaw_rad, mount.yaw_rad, 1e-12);
  // Yaw alone takes the camera's x axis to (cos, sin).
  const Eigen::Matrix4d T = mount_matrix({0, 0, 0, 0, 0, 0.5});
  EXPECT_NEAR(T(0, 0), std::cos(0.5), 1e-12);
  EXPECT_NEAR(T(1, 0), std::sin(0.5), 1e-12);
}

}  // namespace
}  // namespace zenith::tools
