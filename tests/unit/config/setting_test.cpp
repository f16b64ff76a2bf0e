#include "platform/config/setting.h"

#include <unistd.h>

#include <array>
#include <fstream>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/config/robot_settings.h"

namespace zenith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

enum class Colour { kRed, kGreen };

struct Values {
  double rate_hz = 2.5;
  int count = 3;
  std::uint32_t mask = 1;
  std::uint64_t seed = 7;
  bool on = false;
  std::string name = "it";
  Colour colour = Colour::kRed;
};

Settings settings_of(Values& v) {
  return {
      {"top", "", 0, 0, "at the top", &v.name},
      {"camera.rate_hz", "1/s", 0.1, 100, "frames", &v.rate_hz},
      {"camera.count", "", -5, 5, "of them", &v.count},
      {"camera.deep.mask", "", 0, 255, "bits", &v.mask},
      {"camera.deep.on", "", 0, 0, "switch", &v.on},
      {"light.seed", "", 0, 1e18, "of chance", &v.seed},
      {"light.colour", "", 0, 0, "of it", choice_of(v.colour, {"red", "green"})},
  };
}

class SettingTest : public testing::Test {
 protected:
  ~SettingTest() override { std::filesystem::remove(file_); }

  std::string read(const std::string& text) {
    std::ofstream(file_) << text;
    Problems problems(file_);
    read_settings(file_, settings_of(values_), problems);
    return problems.any() ? problems.error().message : "";
  }

  Values values_;
  std::filesystem::path file_ = std::filesystem::temp_directory_path() /
                                ("zenith-setting-" + std::to_string(::getpid()) + ".toml");
};

TEST_F(SettingTest, ReadsEveryTypeAndLeavesTheRest) {
  EXPECT_EQ(read("top = \"that\"\n[camera]\nrate_hz = 30\ncount = -2\n[camera.deep]\nmask = 0x1F\n"
                 "on = true\n[light]\nseed = 123456789012\ncolour = \"green\"\n"),
            "");
  EXPECT_EQ(values_.name, "that");
  EXPECT_EQ(values_.rate_hz, 30.0);
  EXPECT_EQ(values_.count, -2);
  EXPECT_EQ(values_.mask, 31u);
  EXPECT_EQ(values_.seed, 123456789012u);
  EXPECT_TRUE(values_.on);
  EXPECT_EQ(values_.colour, Colour::kGreen);
  values_ = {};
  EXPECT_EQ(read(""), "");
  EXPECT_EQ(values_.rate_hz, 2.5);
}

TEST_F(SettingTest, TellsEverythingThatIsWrongWithItsLine) {
  const std::string wrong = read(
      "[camera]\nrate_hs = 30\nrate_hz = \"fast\"\ncount = 9\n[camera.deep]\nmask = -1\non = 1\n"
      "[light]\ncolour = \"blue\"\nmask = 3\n[lamp]\nx = 1\n");
  EXPECT_THAT(wrong,
              AllOf(HasSubstr(":2: unknown key camera.rate_hs; did you mean camera.rate_hz?"),
                    HasSubstr(":3: camera.rate_hz is no number"),
                    HasSubstr(":4: camera.count is 9, expected -5 .. 5"),
                    HasSubstr(":6: camera.deep.mask is no whole number from 0 on"),
                    HasSubstr(":7: camera.deep.on is neither true nor false")));
  EXPECT_THAT(wrong, AllOf(HasSubstr(":9: light.colour 'blue' is unknown; known: red, green"),
                           HasSubstr(":10: unknown key light.mask; did you mean camera.deep.mask?"),
                           HasSubstr(":11: unknown key lamp")));
}

TEST_F(SettingTest, TellsWhatIsNoTomlAndNoSection) {
  EXPECT_THAT(read("[camera]\nrate_hz = = 3\n"), HasSubstr(":2: "));
  EXPECT_THAT(read("camera = 3\n"), HasSubstr(":1: camera is no section"));
  EXPECT_THAT(read("[camera]\nrate_hz = nan\n"), HasSubstr(":2: camera.rate_hz is nan"));
  EXPECT_THAT(read("[camera.deep]\nmask = 4294967296\n"), HasSubstr("no whole number"));
}

TEST_F(SettingTest, AListHoldsAsManyNumbersAsItHasRoomFor) {
  std::array<double, 3> list = {7.0, 7.0, 7.0};
  const Settings settings = {{"a.list", "", 0, 0, "some", std::span<double>(list)}};
  const auto parse = [&](const char* text) {
    Problems problems(file_);
    parse_settings(text, settings, problems);
    return problems.any() ? problems.error().message : "";
  };
  EXPECT_EQ(parse("[a]\nlist = [1, -2.5]\n"), "");
  EXPECT_EQ(list, (std::array<double, 3>{1.0, -2.5, 0.0}));
  EXPECT_EQ(toml_value(settings[0]), "[1, -2.5]");
  EXPECT_THAT(parse("[a]\nlist = [1, 2, 3, 4]\n"), HasSubstr(":2: a.list holds 4 numbers"));
  EXPECT_THAT(parse("[a]\nlist = [1, nan]\n"), HasSubstr(":2: a.list holds what is no number"));
  EXPECT_THAT(parse("[a]\nlist = [\"x\"]\n"), HasSubstr(":2: a.list holds what is no number"));
  EXPECT_THAT(parse("[a]\nlist = 3\n"), HasSubstr(":2: a.list is no list of numbers"));
  EXPECT_EQ(parse("[a]\nlist = []\n"), "");
  EXPECT_EQ(toml_value(settings[0]), "[]");
}

TEST_F(SettingTest, AFieldOfViewIsANumberOrAuto) {
  Parameters parameters;
  const Settings settings = slam_settings(parameters);
  const auto parse = [&](const char* text) {
    Problems problems(file_);
    parse_settings(text, settings, problems);
    return problems.any() ? problems.error().message : "";
  };
  EXPECT_EQ(toml_value(settings[0]), "\"auto\"");
  EXPECT_EQ(parse("[slam]\nrectified_fov_deg = 95\n"), "");
  EXPECT_EQ(parameters.rectified_fov_deg, 95.0);
  EXPECT_EQ(toml_value(settings[0]), "95");
  EXPECT_EQ(parse("[slam]\nrectified_fov_deg = \"auto\"\n"), "");
  EXPECT_EQ(parameters.rectified_fov_deg, kFittedView);
  EXPECT_THAT(parse("[slam]\nrectified_fov_deg = 0\n"), HasSubstr("is 0, expected 10 .. 150"));
  EXPECT_THAT(parse("[slam]\nrectified_fov_deg = \"wide\"\n"),
              HasSubstr("rectified_fov_deg is no number, nor \"auto\""));
}

TEST_F(SettingTest, MissingIsToldOnlyOfWhatIsRequired) {
  Settings settings = settings_of(values_);
  settings[1].required = true;
  std::ofstream(file_) << "[camera]\ncount = 1\n";
  Problems problems(file_);
  read_settings(file_, settings, problems);
  EXPECT_THAT(problems.error().message,
              AllOf(HasSubstr("missing key camera.rate_hz"), Not(HasSubstr("light"))));
}

TEST_F(SettingTest, WrittenValuesComeBack) {
  Values put;
  put.name = "a \"quoted\" \\ text\n\x1b\x7f\u00fc";
  put.rate_hz = 0.1;
  put.colour = Colour::kGreen;
  std::string text;
  std::string section;
  for (const Setting& setting : settings_of(put)) {
    const auto [in, key] = split_key(setting.key);
    if (in != section) text += "[" + in + "]\n";
    section = in;
    text += key + " = " + toml_value(setting) + "\n";
  }
  EXPECT_EQ(read(text), "");
  EXPECT_EQ(values_.name, put.name);
  EXPECT_EQ(values_.rate_hz, put.rate_hz);
  EXPECT_EQ(values_.colour, put.colour);
}

TEST(RobotSettings, HoldEveryCodecAndParameterOnce) {
  WheelCodecConfig odometry;
  Parameters parameters;
  EXPECT_EQ(odometry_settings(odometry).size(), wheel_codec_fields().size() + 1);
  EXPECT_EQ(slam_settings(parameters).size(), parameter_table().size());
  // The words stand in the order of the enum.
  const Setting codec = odometry_settings(odometry)[0];
  for (std::size_t i = 0; i < std::get<Choice>(codec.at).words.size(); ++i) {
    std::get<Choice>(codec.at).set(i);
    EXPECT_EQ(std::get<Choice>(codec.at).words[i], wheel_codec_name(odometry.kind));
  }
}

TEST(RobotSettings, InterfacesHaveNames) {
  EXPECT_TRUE(is_interface_name("can0"));
  for (const char* name : {"", "can/0", "can 0", "sixteen-letters-"}) {
    EXPECT_FALSE(is_interface_name(name)) << name;
  }
}

}  // namespace
}  // namespace zenith
