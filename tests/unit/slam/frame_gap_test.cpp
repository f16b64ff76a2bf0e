// The camera is away for seconds while the robot goes on: the wheels are followed sample by sample,
// by the map's pose and by the published odometry.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "slam/slam.h"
#include "tests/support/figure.h"
#include "tests/support/hall.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr std::int64_t kSample_ns = 10'000'000;
constexpr int kSamplesPerFrame = 10;
constexpr double kSpeed_m_per_s = 0.5;

// Drives a slalom under a ceiling of tiles, with wheels that tell the truth.
class Slalom {
 public:
  explicit Slalom(std::uint64_t seed)
      : memory_(Slam::memory_needed(Parameters{})),
        slam_(small_robot(), Parameters{}, seed, memory_.span()),
        hall_(small_robot().lens) {}

  void go_on(int samples) {
    for (int k = 0; k < samples; ++k) {
      const double d = kSpeed_m_per_s * 1e-9 * kSample_ns;
      const double turn = 0.008 * std::sin(0.012 * step_++);
      const double half = 0.5 * turn * small_robot().wheels.track_width_m;
      left_m_ += d - half;
      right_m_ += d + half;
      truth_ = truth_ * wheel_motion(small_robot().wheels, {d - half, d + half});
      time_ns_ += kSample_ns;
      wheels_.push_back({{time_ns_}, left_m_, right_m_});
    }
  }
  // The first frame is taken where the truth begins.
  void start() {
    go_on(1);
    truth_ = {};
    see();
  }
  const StepOutput& see() {
    const StepOutput& output =
        slam_.step({{time_ns_}, hall_.seen_from(truth_), wheels_, kMaxCorners});
    wheels_.clear();
    return output;
  }
  // To the core without a frame, as the daemon does when its buffer is full.
  void give_wheels() {
    slam_.add_wheels(wheels_);
    wheels_.clear();
  }
  double error_m(const Pose2& pose) const { return (pose.position() - truth_.position()).norm(); }

 private:
  MemoryBlock memory_;
  Slam slam_;
  Hall hall_;
  std::vector<WheelSample> wheels_;
  std::int64_t time_ns_ = 1'000'000'000;
  int step_ = 0;
  double left_m_ = 7.0;
  double right_m_ = 3.0;
  Pose2 truth_;
};

// A gap of so many samples, after 2 s of frames and before 2 s of them.
void expect_no_loss(std::uint64_t seed, int gap, bool early) {
  Slalom robot(seed);
  robot.start();
  for (int i = 0; i < 20; ++i) {
    robot.go_on(kSamplesPerFrame);
    robot.see();
  }
  for (int k = 0; k < gap; k += 100) {
    robot.go_on(100);
    if (early) robot.give_wheels();
  }
  const StepOutput& after = robot.see();
  const double filter_m = robot.error_m(after.T_start_robot);
  // Two seconds of driving tell the heading to some milliradians, which the way in the gap turns
  // into metres.
  const double most_m = 0.02 + 0.005 * gap * kSpeed_m_per_s * 1e-9 * kSample_ns;
  EXPECT_LT(filter_m, most_m) << gap << " samples";
  EXPECT_LT(robot.error_m(after.odometry.T_odom_robot), 1e-3) << gap << " samples";
  for (int i = 0; i < 20; ++i) {
    robot.go_on(kSamplesPerFrame);
    robot.see();
  }
  EXPECT_LT(robot.error_m(after.T_start_robot), most_m + 0.02) << gap << " samples";
  print_figure("slam: %d samples without a frame, the pose then off by %.4f m", gap, filter_m);
}

TEST(FrameGap, TheWheelsAreFollowedSampleBySample) {
  const TestSeed seed;
  expect_no_loss(seed.value(), 100, false);
  expect_no_loss(seed.value(), 400, false);
  expect_no_loss(seed.value(), 400, true);
  expect_no_loss(seed.value(), 1500, false);
}

}  // namespace
}  // namespace zenith
