#include "platform/daemon/config.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/daemon/config_text.h"
#include "platform/daemon/housekeeping.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using tools::read_text;
using tools::write_text;

class ConfigTest : public testing::Test {
 protected:
  std::string refusal(const std::string& text) {
    write_text(file_, text);
    const auto config = read_daemon_config(file_);
    return config.ok() ? "" : config.error().message;
  }
  DaemonConfig read(const std::string& text) {
    write_text(file_, text);
    const auto config = read_daemon_config(file_);
    EXPECT_TRUE(config.ok()) << config.error().message;
    return config.ok() ? *config : DaemonConfig{};
  }

  tools::TemporaryFolder folder_;
  fs::path file_ = folder_.path() / "zenith.toml";
};

TEST_F(ConfigTest, AnEmptyFileIsTheDefaults) {
  const DaemonConfig config = read("");
  EXPECT_THAT(changed_keys(DaemonConfig{}, config, true), IsEmpty());
  EXPECT_THAT(changed_keys(DaemonConfig{}, config, false), IsEmpty());
}

TEST_F(ConfigTest, TellsEverythingThatIsWrongAtOnceWithItsLine) {
  EXPECT_THAT(
      refusal("[camera]\nrate_hz = 0\ndevise = \"/dev/video1\"\n[slam]\nparticels = 3\n"
              "[load]\nrate_hz = 5.0\n[odometry]\ncodec = \"canbus\"\n"),
      AllOf(HasSubstr("zenith.toml:2: camera.rate_hz is 0, expected 0.1 .. 1000"),
            HasSubstr("zenith.toml:3: unknown key camera.devise; did you mean camera.device?"),
            HasSubstr("zenith.toml:5: unknown key slam.particels; did you mean slam.particles?"),
            HasSubstr("zenith.toml:7: unknown key load.rate_hz; did you mean camera.rate_hz?"),
            HasSubstr("zenith.toml:9: odometry.codec 'canbus' is unknown; known: agilex_v2")));
}

TEST_F(ConfigTest, TellsWhatDoesNotGoTogetherWithItsLine) {
  EXPECT_THAT(refusal("[camera]\ndriver = \"simulated\"\n[lens]\ncu_px = 900\n[realtime]\n"
                      "cpus = \"3-1\"\n[load]\ncorners_min = 100\n[slam]\ncorners_max = 60\n"),
              AllOf(HasSubstr(":2: camera.driver and odometry.driver: either both"),
                    HasSubstr(":4: lens.cu_px lies outside of the frame"),
                    HasSubstr(":6: realtime.cpus: expected CPUs"),
                    HasSubstr(":8: load.corners_min is above slam.corners_max")));
  EXPECT_THAT(refusal("[lens]\nk1 = -2\n"),
              HasSubstr(":2: lens.k1 and the other numbers (k1 k2 k3 k4) fold the image over"));
  EXPECT_THAT(refusal("[leds]\nstatus = \"lamp\"\n"), HasSubstr(":2: leds: "));
  EXPECT_THAT(refusal("[telemetry]\nsocket = \"\"\n"), HasSubstr(":2: telemetry.socket is empty"));
  EXPECT_THAT(refusal("[odometry]\ncodec = \"vesc\"\n[odometry.vesc]\nleft_id = 1\n"),
              HasSubstr(":2: odometry of codec vesc: "));
  EXPECT_THAT(refusal("[odometry]\ncan_interface = \"can 0\"\n"), HasSubstr("no interface's name"));
  EXPECT_THAT(refusal("[odometry]\ncodec = \"odrive\"\ndriver = \"simulated\"\n[camera]\n"
                      "driver = \"simulated\"\n"),
              HasSubstr(":2: odometry.codec: simulated robots speak agilex_v2"));
  EXPECT_THAT(
      refusal("[odometry]\ndriver = \"replay\"\n"),
      HasSubstr(":2: camera.driver and odometry.driver: either both are \"replay\" or neither"));
  EXPECT_THAT(refusal("[camera]\ndriver = \"replay\"\n[odometry]\ndriver = \"replay\"\n"),
              HasSubstr(":2: camera.driver = \"replay\" needs replay.folder"));
}

TEST_F(ConfigTest, AMissingFileSaysWhereOneComesFrom) {
  const auto config = read_daemon_config(folder_.path() / "none.toml");
  ASSERT_FALSE(config.ok());
  EXPECT_THAT(config.error().message, AllOf(HasSubstr("none.toml"), HasSubstr("--print-config")));
}

TEST_F(ConfigTest, GivesDriversWhatTheyNeed) {
  const DaemonConfig config = read(
      "[camera]\nexposure = \"manual\"\ngain = 7\npower_line = \"60Hz\"\n[lens]\nwidth_px = 800\n"
      "height_px = 600\n[mount]\nroll_deg = 90e-1\nyaw_deg = -180\n[log]\nlevel = \"debug\"\n"
      "[odometry.dbc]\nfile = \"base.dbc\"\n[replay]\nfolder = \"rec\"\n");
  const V4l2Settings v4l2 = config.v4l2();
  EXPECT_EQ(v4l2.width, 800);
  EXPECT_EQ(v4l2.height, 600);
  EXPECT_EQ(v4l2.exposure, V4l2Exposure::kManual);
  EXPECT_EQ(v4l2.power_line, V4l2PowerLine::k60Hz);
  EXPECT_EQ(v4l2.gain, 7);
  EXPECT_EQ(DaemonConfig{}.v4l2().gain, std::nullopt);
  EXPECT_NEAR(config.robot().mount.roll_rad, 0.157079633, 1e-9);
  EXPECT_NEAR(config.robot().mount.yaw_rad, -3.14159265, 1e-8);
  EXPECT_EQ(config.log_level(), LogLevel::kDebug);
  EXPECT_EQ(config.odometry.dbc.file, (folder_.path() / "base.dbc").string());
  EXPECT_EQ(config.replay.folder, (folder_.path() / "rec").string());
}

// Enums stand in the order of their words.
TEST_F(ConfigTest, WordsMeanWhatTheySay) {
  const DaemonConfig libcamera =
      read("[camera]\ndriver = \"libcamera\"\nid = \"imx219\"\n[lens]\nwidth_px = 800\n");
  EXPECT_EQ(libcamera.camera_driver, CameraDriver::kLibcamera);
  EXPECT_EQ(libcamera.libcamera().device, "imx219");
  EXPECT_EQ(libcamera.libcamera().width, 800);
  EXPECT_EQ(read("[camera]\nexposure = \"auto\"\n").camera.exposure, V4l2Exposure::kAuto);
  EXPECT_EQ(read("[camera]\npower_line = \"50Hz\"\n").camera.power_line, V4l2PowerLine::k50Hz);
  EXPECT_EQ(read("[camera]\npower_line = \"auto\"\n").camera.power_line, V4l2PowerLine::kAuto);
  EXPECT_EQ(read("[log]\nlevel = \"error\"\n").log_level(), LogLevel::kError);
  EXPECT_EQ(read("[log]\nlevel = \"notice\"\n").log_level(), LogLevel::kNotice);
}

TEST(Cpus, AreNumbersAndRanges) {
  EXPECT_EQ(*parse_cpus(""), 0u);
  EXPECT_EQ(*parse_cpus("2"), 0b100u);
  EXPECT_EQ(*parse_cpus("0,2-3"), 0b1101u);
  EXPECT_EQ(*parse_cpus("63"), std::uint64_t{1} << 63);
  for (const char* text : {"64", "x", "1-", "3-1", "1,", ",1", "1;2", "-1"}) {
    EXPECT_FALSE(parse_cpus(text).ok()) << text;
  }
}

TEST(DaemonSettings, AreUniqueAndExplained) {
  DaemonConfig config;
  std::set<std::string> keys;
  for (const Setting& setting : daemon_settings(config)) {
    EXPECT_TRUE(keys.insert(setting.key).second) << setting.key;
    EXPECT_FALSE(setting.text.empty()) << setting.key;
    EXPECT_NE(split_key(setting.key).first, "") << setting.key;
  }
}

// take_live() takes what the list calls live, and nothing else.
TEST(DaemonSettings, LiveOnesAreTakenOver) {
  DaemonConfig other;
  for (const Setting& setting : daemon_settings(other)) {
    if (const auto* real = std::get_if<double*>(&setting.at)) **real += 1.0;
    if (const auto* whole = std::get_if<int*>(&setting.at)) **whole += 1;
    if (const auto* on = std::get_if<bool*>(&setting.at)) **on = !**on;
    if (const auto* text = std::get_if<std::string*>(&setting.at)) **text += "x";
    if (const auto* choice = std::get_if<Choice>(&setting.at)) {
      choice->set((choice->get() + 1) % choice->words.size());
    }
  }
  DaemonConfig running;
  const auto others = changed_keys(running, other, false);
  EXPECT_GT(others.size(), 20u);
  take_live(other, running);
  EXPECT_THAT(changed_keys(running, other, true), IsEmpty());
  EXPECT_EQ(changed_keys(running, other, false), others);
}

// What of this the perception thread gets; the others are used where they lie.
TEST(DaemonSettings, LiveOnesReachThePerceptionThread) {
  DaemonConfig config;
  config.odometry_patience_s = 0.125;
  config.load.busy_share = 0.75;
  config.load.corners_min = 33;
  config.slam.corners_max = 66;
  const LiveSettings live = live_settings(config);
  EXPECT_EQ(live.patience, Duration::from_seconds(0.125));
  EXPECT_EQ(live.load.busy_share, 0.75);
  EXPECT_EQ(live.load.corners_min, 33);
  EXPECT_EQ(live.load.corners_max, 66);
}

// --- files that are made of the list
// --------------------------------------------------------------

TEST(ConfigFiles, AreThoseThatTheProgramPrints) {
  const fs::path root = ZENITH_SOURCE_DIR;
  EXPECT_EQ(read_text(root / "config" / "zenith.toml"), annotated_config())
      << "write it anew: zenithd --print-config > config/zenith.toml";
  EXPECT_EQ(read_text(root / "docs" / "configuration.md"), config_reference())
      << "write it anew: zenithd --print-reference > docs/configuration.md";
}

TEST(ConfigFiles, AreGood) {
  for (const char* name : {"zenith.toml", "simulated.toml"}) {
    const auto config = read_daemon_config(fs::path(ZENITH_SOURCE_DIR) / "config" / name);
    EXPECT_TRUE(config.ok()) << config.error().message;
  }
  const auto defaults = read_daemon_config(fs::path(ZENITH_SOURCE_DIR) / "config" / "zenith.toml");
  EXPECT_THAT(changed_keys(DaemonConfig{}, *defaults, false), IsEmpty());
  EXPECT_THAT(changed_keys(DaemonConfig{}, *defaults, true), IsEmpty());
}

}  // namespace
}  // namespace zenith
