// Every codec with all that happens on a bus: loss, repetition, late frames, wraps, restarts.

#include "tests/support/wheel_bases.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include <gtest/gtest.h>

#include "tests/unit/drivers/odometry/frame_bytes.h"

namespace zenith {
namespace {

constexpr double kLeft_mps = 0.41;
constexpr double kRight_mps = -0.73;
constexpr std::int64_t kPeriod_ms = 20;

class WheelBases : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    char name[] = "/tmp/zenith_bases_XXXXXX";
    ASSERT_NE(::mkdtemp(name), nullptr);
    folder_ = name;
    const std::string file = (folder_ / "bases.dbc").string();
    std::ofstream(file) << kWheelBasesDbc;
    base_ = all_wheel_bases(file).at(GetParam());
    const auto decoder = make_wheel_decoder(base_.config);
    ASSERT_TRUE(decoder.ok()) << decoder.error().message;
    decoder_ = *decoder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // What the base sends in its `step`-th period, both wheels at constant speeds.
  std::vector<CanFrame> frames_of(int step) const {
    const double time_s = 0.001 * static_cast<double>(kPeriod_ms * step);
    return base_.send({at_ms(1000 + kPeriod_ms * step), start_left_m_ + kLeft_mps * time_s,
                       start_right_m_ + kRight_mps * time_s, kLeft_mps, kRight_mps});
  }
  void feed(const std::vector<CanFrame>& frames) {
    for (const CanFrame& frame : frames) {
      if (const auto sample = decoder_.decode(frame)) last_ = sample;
    }
  }
  // The travel after `step` periods, as far as the base resolves it.
  void expect_travel(double steps) const {
    ASSERT_TRUE(last_.has_value());
    const double time_s = 0.001 * static_cast<double>(kPeriod_ms) * steps;
    const double tolerance =
        base_.velocity ? 0.002 * time_s + 1e-9 : 2.0 * base_.resolution_m + 1e-6;
    EXPECT_NEAR(last_->left_m, kLeft_mps * time_s, tolerance);
    EXPECT_NEAR(last_->right_m, kRight_mps * time_s, tolerance);
  }

  std::filesystem::path folder_;
  WheelBase base_;
  WheelDecoder decoder_;
  double start_left_m_ = 12.3;
  double start_right_m_ = -45.6;
  std::optional<WheelSample> last_;
};

TEST_P(WheelBases, TravelIsThatOfTheWheels) {
  for (int step = 0; step <= 100; ++step) feed(frames_of(step));
  expect_travel(100);
  EXPECT_EQ(decoder_.counters().samples, 101u);
  EXPECT_EQ(decoder_.counters().resets, 0u);
  EXPECT_EQ(decoder_.counters().unknown_ids, 0u);
  EXPECT_EQ(decoder_.counters().unpaired, 0u);
}

TEST_P(WheelBases, RepeatedAndLateFramesChangeNothing) {
  for (int step = 0; step <= 50; ++step) {
    feed(frames_of(step));
    feed(frames_of(step));
    if (step > 3) feed(frames_of(step - 3));
  }
  expect_travel(50);
  EXPECT_EQ(decoder_.counters().samples, 51u);
  EXPECT_GE(decoder_.counters().late, 97u);
  EXPECT_EQ(decoder_.counters().resets, 0u);
}

TEST_P(WheelBases, LostFramesCostNoTravel) {
  for (int step = 0; step <= 100; ++step) {
    const int phase = step % 20;
    if (phase >= 5 && phase < 12 && step < 100) continue;
    feed(frames_of(step));
  }
  expect_travel(100);
  EXPECT_EQ(decoder_.counters().resets, 0u);
}

TEST_P(WheelBases, CountersWrapAtBothEndsInBothDirections) {
  if (base_.wrap_m == 0.0) return;  // floats and velocities do not wrap
  for (const double wrap_m : {base_.wrap_m, 0.5 * base_.wrap_m}) {
    SCOPED_TRACE(wrap_m);
    decoder_ = *make_wheel_decoder(base_.config);
    start_left_m_ = wrap_m - 0.3;   // forward through the end
    start_right_m_ = wrap_m + 0.3;  // backward through it
    for (int step = 0; step <= 100; ++step) feed(frames_of(step));
    expect_travel(100);
    EXPECT_EQ(decoder_.counters().resets, 0u);
  }
}

TEST_P(WheelBases, ARestartIsNoMotion) {
  for (int step = 0; step <= 50; ++step) feed(frames_of(step));
  const double lost_s = 0.001 * kPeriod_ms * 51;
  start_left_m_ = -kLeft_mps * lost_s;  // zero in the next step
  start_right_m_ = -kRight_mps * lost_s;
  for (int step = 51; step <= 100; ++step) feed(frames_of(step));
  // Positions miss the step over the restart; velocities miss nothing.
  expect_travel(base_.velocity ? 100 : 99);
  EXPECT_EQ(decoder_.counters().resets > 0, !base_.velocity);
}

TEST_P(WheelBases, ShortFramesAreRefused) {
  feed(frames_of(0));
  const std::uint64_t before = decoder_.counters().samples;
  for (CanFrame frame : frames_of(1)) {
    frame.length = 3;
    feed({frame});
  }
  EXPECT_EQ(decoder_.counters().samples, before);
  EXPECT_GE(decoder_.counters().short_frames, 1u);
  feed(frames_of(2));
  expect_travel(2);
}

// The kernel's filter lets through what the decoder needs.
TEST_P(WheelBases, ListedIdentifiersAreEnough) {
  const CanIds ids = decoder_.ids();
  for (int step = 0; step <= 20; ++step) {
    for (const CanFrame& frame : frames_of(step)) {
      for (const CanId& id : ids) {
        if (id_of(frame) == id) feed({frame});
      }
    }
  }
  expect_travel(20);
  EXPECT_EQ(decoder_.counters().samples, 21u);
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& info) {
  return all_wheel_bases("")[info.param].name;
}

INSTANTIATE_TEST_SUITE_P(All, WheelBases,
                         ::testing::Range(std::size_t{0}, all_wheel_bases("").size()), name_of);

}  // namespace
}  // namespace zenith
