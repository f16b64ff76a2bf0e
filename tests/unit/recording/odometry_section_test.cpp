// The section [odometry] of robot.toml, and recordings of every base that it can describe.

#include "platform/recording/odometry_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/config/robot_settings.h"
#include "platform/recording/candump.h"
#include "platform/recording/layout.h"
#include "platform/recording/recording.h"
#include "tests/support/wheel_bases.h"
#include "tests/unit/tools/small_recording.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class OdometrySection : public testing::Test {
 protected:
  void SetUp() override {
    write_small_recording(folder_);
    write_text(folder_ / "bases.dbc", kWheelBasesDbc);
  }

  // Makes the recording that of another base, which drives as the AgileX one did.
  void become(const WheelBase& base) const {
    RobotFile robot;
    robot.wheels = small_robot().wheels;
    robot.odometry = base.config;
    write_text(layout::robot(folder_), format_robot_file(robot));
    std::string log;
    for (int i = 0; i <= 60; ++i) {
      const Time stamp{1'000'000'000 + i * 20'000'000LL};
      for (const CanFrame& frame : base.send({stamp, 0.01 * i, 0.011 * i, 0.5, 0.55})) {
        log += format_candump(frame, "can0") + "\n";
      }
    }
    write_text(layout::can_log(folder_, "can0"), log);
  }

  // The samples of the whole recording; the error, or warnings, are told as failures.
  std::vector<WheelSample> read_all() const {
    std::vector<WheelSample> samples;
    const auto recording = Recording::open(folder_, {});
    EXPECT_TRUE(recording.ok()) << recording.error().message;
    if (!recording.ok()) return samples;
    SourceFrame frame;
    while (true) {
      const auto more = (*recording)->next(frame);
      EXPECT_TRUE(more.ok());
      if (!more.ok() || !*more) break;
      samples.insert(samples.end(), frame.wheels.begin(), frame.wheels.end());
    }
    EXPECT_THAT((*recording)->warnings(), IsEmpty());
    return samples;
  }

  std::string refusal(const std::string& odometry) const {
    write_text(layout::robot(folder_),
               "[wheels]\ntrack_width_m = 0.4\nleft_scale = 1.0\nright_scale = 1.0\n[odometry]\n"
               "can_interface = \"can0\"\n" +
                   odometry);
    const auto recording = Recording::open(folder_, {});
    return recording.ok() ? "opened" : recording.error().message;
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "ada";
};

TEST_F(OdometrySection, RecordingsOfEveryBaseGiveTheSameTravel) {
  for (const WheelBase& base : all_wheel_bases("bases.dbc")) {
    SCOPED_TRACE(base.name);
    become(base);
    const auto samples = read_all();
    ASSERT_GE(samples.size(), 46u);
    const double tolerance_m = base.velocity ? 0.003 : 2.0 * base.resolution_m + 1e-6;
    for (const WheelSample& sample : samples) {
      const double steps = static_cast<double>(sample.stamp.ns - 1'000'000'000) / 20e6;
      EXPECT_NEAR(sample.left_m, 0.01 * steps, tolerance_m);
      EXPECT_NEAR(sample.right_m, 0.011 * steps, tolerance_m);
    }
  }
}

TEST_F(OdometrySection, ComesBackAsItWasWritten) {
  for (const WheelBase& base : all_wheel_bases("/where/ever \"it\" is.dbc")) {
    SCOPED_TRACE(base.name);
    RobotFile robot;
    robot.odometry = base.config;
    robot.odometry.limits = {.max_speed_mps = 3.25, .max_gap_s = 1.5, .max_velocity_gap_s = 0.4};
    robot.odometry.invert_left = true;
    const fs::path file = folder_ / "again.toml";
    write_text(file, format_robot_file(robot));
    auto read = read_robot_file(file);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->odometry.kind, base.config.kind);
    for (const WheelCodecField& field : wheel_codec_fields()) {
      if (!field.belongs_to(base.config.kind)) continue;
      EXPECT_EQ(toml_value(odometry_setting(field, read->odometry)),
                toml_value(odometry_setting(field, robot.odometry)))
          << field.key;
    }
  }
}

TEST_F(OdometrySection, TellsMistakesWithTheirLines) {
  EXPECT_THAT(refusal("codec = \"odrive\"\nwheel_radius = 0.1\n[odometry.odrive]\nleft_nod = 3\n"
                      "right_node = -1\nquantity = \"speed\"\n"),
              AllOf(HasSubstr("robot.toml:8: unknown key odometry.wheel_radius; did you mean "
                              "odometry.wheel_radius_m?"),
                    HasSubstr("robot.toml:10: unknown key odometry.odrive.left_nod"),
                    HasSubstr("robot.toml:11: odometry.odrive.right_node is no whole number"),
                    HasSubstr("robot.toml:12: odometry.odrive.quantity 'speed' is unknown; known: "
                              "position, velocity")));
  EXPECT_THAT(refusal("codec = \"vesc\"\ngear_ratio = 0.0\n[odometry.vesc]\nleft_id = 1\n"),
              HasSubstr("robot.toml:8: odometry.gear_ratio is 0, expected 0.01 .. 1000"));
  EXPECT_THAT(refusal("codec = \"vesc\"\n[odometry.vesc]\nleft_id = 1\n"),
              HasSubstr("robot.toml: odometry of codec vesc: vesc: the controller's id "
                        "is 1 for both"));
  EXPECT_THAT(refusal("codec = \"dbc\"\nodrive = 3\n"), HasSubstr("odometry.odrive is no section"));
  EXPECT_THAT(refusal("wheel_radius_m = 0.1\n"), HasSubstr("missing key odometry.codec"));
  EXPECT_THAT(refusal("codec = \"canbus\"\n"),
              HasSubstr("'canbus' is unknown; known: agilex_v2, odrive, vesc, canopen, dbc"));
}

TEST_F(OdometrySection, DbcFilesLieBesideRobotToml) {
  const std::string section =
      "codec = \"dbc\"\n[odometry.dbc]\nleft_signal = \"ODO_L\"\nright_signal = \"ODO_R\"\n"
      "quantity = \"position\"\n";
  EXPECT_THAT(refusal(section), HasSubstr("dbc.file is missing"));
  EXPECT_THAT(refusal(section + "file = \"other.dbc\"\n"),
              HasSubstr((folder_ / "other.dbc").string() + ": missing or cannot be opened"));
  EXPECT_THAT(refusal(section + "file = \"bases.dbc\"\n"), HasSubstr("holds no odometry"));
}

// docs/file-formats.md has a row for each key.
TEST(OdometryKeys, AreDocumented) {
  const std::string page = read_text(fs::path(ZENITH_SOURCE_DIR) / "docs" / "file-formats.md");
  WheelCodecConfig defaults;
  std::string missing;
  for (const WheelCodecField& field : wheel_codec_fields()) {
    char range[64] = "";
    if (field.max > field.min) {
      std::snprintf(range, sizeof range, "%.10g .. %.10g", field.min, field.max);
    }
    std::string row = "| `" + std::string(field.key) + "` | " +
                      toml_value(odometry_setting(field, defaults)) + " | " + range + " | " +
                      std::string(field.unit) + " | ";
    row += std::string(field.text) + " |\n";
    if (page.find(row) == std::string::npos) missing += row;
  }
  EXPECT_EQ(missing, "") << "rows that docs/file-formats.md lacks";
}

}  // namespace
}  // namespace zenith::tools
