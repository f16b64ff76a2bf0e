// Wheel speeds of a real car: its CAN log, its DBC file, and what another program decoded.

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/odometry/dbc.h"
#include "drivers/odometry/dbc_signal.h"
#include "drivers/odometry/wheel_codec_config.h"
#include "platform/recording/candump.h"
#include "platform/recording/wheel_log.h"
#include "tests/support/figure.h"
#include "tests/support/real_data.h"

namespace zenith::tools {
namespace {

constexpr double kMpsPerKmh = 1.0 / 3.6;
// The file has six decimals.
constexpr double kHalfDigit = 0.51e-6;

struct Speeds {
  double time_s = 0.0;
  double wheel_mps[4] = {};  // front left, front right, rear left, rear right
};

class CarWheels : public ::testing::Test {
 protected:
  void SetUp() override {
    ZENITH_NEED_REAL_DATA("can_wheel_speeds");
    folder_ = real_data_folder() / "can_wheel_speeds";
    std::ifstream file(folder_ / "expected_wheel_speeds.csv");
    std::string line;
    while (std::getline(file, line)) {
      Speeds row;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &row.time_s, &row.wheel_mps[0],
                      &row.wheel_mps[1], &row.wheel_mps[2], &row.wheel_mps[3]) == 5) {
        expected_.push_back(row);
      }
    }
    ASSERT_EQ(expected_.size(), 1658u);
  }

  WheelCodecConfig config(const char* left, const char* right) const {
    WheelCodecConfig config;
    config.kind = WheelCodecKind::kDbc;
    config.limits.max_speed_mps = 50.0;
    config.dbc = {(folder_ / "vehicle.dbc").string(), left, right, WheelQuantity::kVelocity,
                  kMpsPerKmh};
    return config;
  }

  std::filesystem::path folder_;
  std::vector<Speeds> expected_;
};

TEST_F(CarWheels, EverySpeedIsWhatTheOtherProgramDecoded) {
  const auto dbc = load_dbc((folder_ / "vehicle.dbc").string());
  ASSERT_TRUE(dbc.ok()) << dbc.error().message;
  std::vector<DbcSignal> signals;
  for (const char* name : {"VXFL", "VXFR", "VXRL", "VXRR"}) {
    const auto signal = find_signal(*dbc, name);
    ASSERT_TRUE(signal.ok()) << signal.error().message;
    EXPECT_TRUE(signal->signal.motorola);
    signals.push_back(signal->signal);
  }
  std::ifstream log(folder_ / "candump.log");
  std::size_t row = 0;
  std::size_t others = 0;
  std::string line;
  while (std::getline(log, line)) {
    const CandumpRecord record = parse_candump(line);
    const CanFrame& frame = record.frame;
    ASSERT_EQ(record.line, CandumpLine::kFrame) << line;
    if (id_of(frame) != signals[0].id) {
      ++others;
      continue;
    }
    ASSERT_LT(row, expected_.size());
    for (std::size_t wheel = 0; wheel < 4; ++wheel) {
      const double kmh = physical_of(signals[wheel], read_raw(signals[wheel], frame));
      ASSERT_NEAR(kMpsPerKmh * kmh, expected_[row].wheel_mps[wheel], kHalfDigit)
          << line << ", wheel " << wheel;
    }
    ASSERT_NEAR(1e-9 * static_cast<double>(frame.stamp.ns), expected_[row].time_s, 1e-6);
    ++row;
  }
  EXPECT_EQ(row, expected_.size());
  EXPECT_GT(others, 10'000u);
}

// The whole way from the log to travel, against the trapezoids of the other program's speeds.
TEST_F(CarWheels, TravelIsTheIntegralOfTheSpeeds) {
  const auto decoder = make_wheel_decoder(config("VXRL", "VXRR"));
  ASSERT_TRUE(decoder.ok()) << decoder.error().message;
  const auto log = read_wheel_log(folder_ / "candump.log", "can0", *decoder);
  ASSERT_TRUE(log.ok()) << log.error().message;
  ASSERT_EQ(log->samples.size(), expected_.size());
  EXPECT_EQ(log->decoder.invalid, 0u);
  EXPECT_EQ(log->decoder.late, 0u);
  EXPECT_EQ(log->decoder.velocity_gaps, 0u);
  EXPECT_EQ(log->can.malformed, 0u);
  double left_m = 0.0;
  double right_m = 0.0;
  for (std::size_t i = 0; i < expected_.size(); ++i) {
    if (i > 0) {
      const Speeds& last = expected_[i - 1];
      const Speeds& now = expected_[i];
      const double half_s = 0.5 * (now.time_s - last.time_s);
      left_m += half_s * (last.wheel_mps[2] + now.wheel_mps[2]);
      right_m += half_s * (last.wheel_mps[3] + now.wheel_mps[3]);
    }
    ASSERT_NEAR(log->samples[i].left_m, left_m, 1e-3);
    ASSERT_NEAR(log->samples[i].right_m, right_m, 1e-3);
  }
  EXPECT_GT(left_m, 150.0);
  const WheelSample& last = log->samples.back();
  print_figure("a car's rear wheels over %.1f s: %.2f m and %.2f m",
               expected_.back().time_s - expected_.front().time_s, last.left_m, last.right_m);
}

TEST_F(CarWheels, MistakesOfTheDbcConfigurationAreTold) {
  const auto decoder = make_wheel_decoder(config("VXRL", "VXRX"));
  ASSERT_FALSE(decoder.ok());
  EXPECT_THAT(decoder.error().message, ::testing::HasSubstr("has no signal 'VXRX'"));
}

}  // namespace
}  // namespace zenith::tools
