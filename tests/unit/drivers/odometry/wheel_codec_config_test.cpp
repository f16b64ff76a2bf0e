#include "drivers/odometry/wheel_codec_config.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string problems(const WheelCodecConfig& config) {
  const auto decoder = make_wheel_decoder(config);
  return decoder.ok() ? "" : decoder.error().message;
}

TEST(WheelCodecConfig, NamesGoBothWays) {
  for (const char* name : {"agilex_v2", "odrive", "vesc", "canopen", "dbc"}) {
    const auto kind = find_wheel_codec(name);
    ASSERT_TRUE(kind.has_value()) << name;
    EXPECT_EQ(wheel_codec_name(*kind), name);
  }
  EXPECT_FALSE(find_wheel_codec("agilex").has_value());
  EXPECT_EQ(wheel_codec_names(), "agilex_v2, odrive, vesc, canopen, dbc");
  EXPECT_EQ(find_wheel_quantity("velocity"), WheelQuantity::kVelocity);
  EXPECT_FALSE(find_wheel_quantity("speed").has_value());
}

TEST(WheelCodecConfig, KeysAreUniqueAndReachDifferentFields) {
  std::set<std::string_view> keys;
  std::set<const void*> places;
  WheelCodecConfig config;
  for (const WheelCodecField& field : wheel_codec_fields()) {
    EXPECT_TRUE(keys.insert(field.key).second) << field.key;
    const auto place = [&](auto at) { return static_cast<const void*>(at(config)); };
    EXPECT_TRUE(places.insert(std::visit(place, field.at)).second) << field.key;
  }
  EXPECT_GT(keys.size(), 25u);
}

TEST(WheelCodecConfig, DefaultsOfBasesWithoutFilesWork) {
  for (const WheelCodecKind kind : {WheelCodecKind::kAgilexV2, WheelCodecKind::kOdrive,
                                    WheelCodecKind::kVesc, WheelCodecKind::kCanopen}) {
    EXPECT_EQ(problems({.kind = kind}), "");
  }
}

TEST(WheelCodecConfig, TellsAllProblemsAtOnce) {
  WheelCodecConfig config;
  config.kind = WheelCodecKind::kVesc;
  config.geometry.wheel_radius_m = -0.1;
  config.geometry.gear_ratio = std::nan("");
  config.limits.max_speed_mps = 0.0;
  config.vesc.left_id = 300;
  config.vesc.right_id = 300;
  config.vesc.counts_per_turn = 0.0;
  config.odrive.left_node = 99;  // not this codec's
  EXPECT_THAT(
      problems(config),
      AllOf(HasSubstr("codec vesc: wheel_radius_m is -0.1, expected 0.005 .. 1"),
            HasSubstr("gear_ratio is nan"), HasSubstr("max_wheel_speed_mps is 0"),
            HasSubstr("vesc.left_id is 300, expected 0 .. 255"), HasSubstr("300 for both wheels"),
            HasSubstr("vesc.counts_per_turn is 0"), Not(HasSubstr("odrive"))));
}

TEST(WheelCodecConfig, ChecksMappings) {
  WheelCodecConfig config;
  config.kind = WheelCodecKind::kCanopen;
  config.canopen.left = {.cob_id = 0x181, .byte_offset = 6, .byte_length = 4};
  config.canopen.right = {.cob_id = 0x900, .byte_offset = 0, .byte_length = 3};
  EXPECT_THAT(problems(config),
              AllOf(HasSubstr("canopen.left: byte_offset + byte_length go beyond"),
                    HasSubstr("canopen.right_cob_id is 2304"),
                    HasSubstr("canopen.right_byte_length is 3, expected 2 or 4")));
  config.canopen.left = {.cob_id = 0x181, .byte_offset = 0};
  config.canopen.right = {.cob_id = 0x181, .byte_offset = 3};
  EXPECT_THAT(problems(config), HasSubstr("same bytes"));
  config.canopen.right.byte_offset = 4;
  EXPECT_EQ(problems(config), "");
}

class DbcConfig : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/zenith_dbc_XXXXXX";
    ASSERT_NE(::mkdtemp(name), nullptr);
    folder_ = name;
    config_.kind = WheelCodecKind::kDbc;
    config_.dbc = {.file = (folder_ / "base.dbc").string(),
                   .left_signal = "L",
                   .right_signal = "R",
                   .metres_per_unit = 0.5};
    std::ofstream(config_.dbc.file) << "BO_ 5 W: 8 X\n"
                                       " SG_ L : 0|16@1- (1,0) [0|0] \"\" X\n"
                                       " SG_ R : 16|16@1- (1,0) [0|0] \"\" X\n"
                                       " SG_ S : 32|4@1- (1,0) [0|0] \"\" X\n"
                                       " SG_ M m1 : 40|16@1- (1,0) [0|0] \"\" X\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  WheelCodecConfig config_;
};

TEST_F(DbcConfig, MakesADecoderOfAFile) {
  auto decoder = make_wheel_decoder(config_);
  ASSERT_TRUE(decoder.ok()) << decoder.error().message;
  decoder->decode(frame_of({5}, {0x02, 0x00, 0xFE, 0xFF}, 0));
  const auto sample = decoder->decode(frame_of({5}, {0x02, 0x00, 0xFE, 0xFF}, 100));
  ASSERT_TRUE(sample.has_value());
  EXPECT_DOUBLE_EQ(sample->left_m, 0.1);
  EXPECT_DOUBLE_EQ(sample->right_m, -0.1);
}

TEST_F(DbcConfig, TellsWhatIsWrongWithTheFileAndItsSignals) {
  config_.dbc.left_signal = "M";
  config_.dbc.right_signal = "NONE";
  config_.dbc.metres_per_unit = 0.0;
  EXPECT_THAT(problems(config_),
              AllOf(HasSubstr("dbc.left_signal: "), HasSubstr("is multiplexed (m1)"),
                    HasSubstr("dbc.right_signal: "), HasSubstr("no signal 'NONE'"),
                    HasSubstr("dbc.metres_per_unit is 0")));
  config_.dbc.left_signal.clear();
  config_.dbc.right_signal.clear();
  EXPECT_THAT(problems(config_), AllOf(HasSubstr("dbc.left_signal is missing"),
                                       HasSubstr("dbc.right_signal is missing")));
  config_.dbc.file.clear();
  EXPECT_THAT(problems(config_), HasSubstr("dbc.file is missing"));
  config_.dbc.file = (folder_ / "other.dbc").string();
  EXPECT_THAT(problems(config_), HasSubstr("cannot be opened"));
}

TEST_F(DbcConfig, RefusesShortCountersAndOneSignalForBoth) {
  config_.dbc.quantity = WheelQuantity::kPosition;
  config_.dbc.left_signal = "S";
  EXPECT_THAT(problems(config_), HasSubstr("S has 4 bits, expected at least 8 in a position"));
  config_.dbc.left_signal = "R";
  EXPECT_THAT(problems(config_), HasSubstr("both wheels are the signal R"));
  config_.dbc.right_signal = "W.R";
  EXPECT_THAT(problems(config_), HasSubstr("both wheels are the signal"));
}

TEST_F(DbcConfig, RefusesWheelsThatShareBits) {
  for (const auto& [right, shared] : std::vector<std::pair<std::string, bool>>{{"16|16@1-", false},
                                                                               {"0|16@1-", true},
                                                                               {"15|16@1-", true},
                                                                               {"23|16@0-", false},
                                                                               {"15|16@0-", true},
                                                                               {"7|16@0-", true}}) {
    std::ofstream(folder_ / "base.dbc")
        << "BO_ 5 W: 8 X\n SG_ L : 0|16@1- (1,0) [0|0] \"\" X\n SG_ R : " << right
        << " (1,0) [0|0] \"\" X\n";
    const auto decoder = make_wheel_decoder(config_);
    EXPECT_EQ(decoder.ok(), !shared) << right;
    if (shared && !decoder.ok()) {
      EXPECT_THAT(decoder.error().message, HasSubstr("the same bits")) << right;
    }
  }
}

// Forward left 1, right 2 turns in the base's words; what the robot makes of it.
WheelSample drive(WheelCodecConfig config) {
  config.kind = WheelCodecKind::kOdrive;
  config.geometry.wheel_radius_m = 0.5 / std::numbers::pi;  // a metre for each turn
  auto decoder = make_wheel_decoder(config);
  EXPECT_TRUE(decoder.ok());
  decoder->decode(odrive::encode_estimates(at_ms(0), 0, {0.0F, 0.0F}));
  decoder->decode(odrive::encode_estimates(at_ms(0), 1, {0.0F, 0.0F}));
  decoder->decode(odrive::encode_estimates(at_ms(1000), 0, {1.0F, 0.0F}));
  const auto sample = decoder->decode(odrive::encode_estimates(at_ms(1000), 1, {2.0F, 0.0F}));
  return sample.value_or(WheelSample{});
}

TEST(WheelCodecConfig, InvertsAndSwapsWheels) {
  EXPECT_DOUBLE_EQ(drive({}).left_m, 1.0);
  EXPECT_DOUBLE_EQ(drive({}).right_m, 2.0);
  EXPECT_DOUBLE_EQ(drive({.invert_left = true}).left_m, -1.0);
  EXPECT_DOUBLE_EQ(drive({.invert_left = true}).right_m, 2.0);
  EXPECT_DOUBLE_EQ(drive({.invert_right = true}).left_m, 1.0);
  EXPECT_DOUBLE_EQ(drive({.invert_right = true}).right_m, -2.0);
  EXPECT_DOUBLE_EQ(drive({.swap_wheels = true}).left_m, 2.0);
  EXPECT_DOUBLE_EQ(drive({.swap_wheels = true}).right_m, 1.0);
  // The robot's left is inverted, which the base calls right.
  EXPECT_DOUBLE_EQ(drive({.swap_wheels = true, .invert_left = true}).left_m, -2.0);
}

TEST(WheelCodecConfig, StampsOfSamplesAreEarlierByTheLatency) {
  auto decoder = make_wheel_decoder({.latency_s = 0.03});
  ASSERT_TRUE(decoder.ok());
  decoder->decode(agilex_v2::encode_odometer(at_ms(100), {0, 0}));
  const auto sample = decoder->decode(agilex_v2::encode_odometer(at_ms(110), {3, 7}));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->stamp, at_ms(80));
}

TEST(WheelCodecConfig, SwapsEveryCodec) {
  const auto left_of = [](const WheelCodecConfig& config, const CanFrame& first,
                          const CanFrame& second) {
    auto decoder = make_wheel_decoder(config);
    if (!decoder.ok()) return std::nan("");
    decoder->decode(first);
    const auto sample = decoder->decode(second);
    return sample ? sample->left_m : std::nan("");
  };
  EXPECT_DOUBLE_EQ(left_of({.swap_wheels = true}, agilex_v2::encode_odometer(at_ms(0), {0, 0}),
                           agilex_v2::encode_odometer(at_ms(10), {3, 7})),
                   0.007);
  WheelCodecConfig canopen;
  canopen.kind = WheelCodecKind::kCanopen;
  canopen.swap_wheels = true;
  canopen.geometry.wheel_radius_m = 0.5 / std::numbers::pi;
  canopen.canopen = {.left = {.cob_id = 0x181, .byte_offset = 0},
                     .right = {.cob_id = 0x181, .byte_offset = 4},
                     .units_per_turn = 1000.0};
  EXPECT_DOUBLE_EQ(left_of(canopen, frame_of({0x181}, {0, 0, 0, 0, 0, 0, 0, 0}, 0),
                           frame_of({0x181}, {3, 0, 0, 0, 7, 0, 0, 0}, 10)),
                   0.007);
}

}  // namespace
}  // namespace zenith
