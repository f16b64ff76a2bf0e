// Pictures that come twice, and one that comes for ever: they must not move robot or map.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "slam/slam.h"
#include "tests/support/hall.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr std::int64_t kPeriod_ns = 100'000'000;
constexpr double kStep_m = 0.05;

// Drives straight on under a ceiling of tiles; the camera's frames are what the test makes of them.
class Drive {
 public:
  explicit Drive(std::uint64_t seed)
      : memory_(Slam::memory_needed(Parameters{})),
        slam_(small_robot(), Parameters{}, seed, memory_.span()),
        hall_(small_robot().lens) {}

  // The robot goes on by half a step, and so do the stamps.
  void half_step() {
    time_ns_ += kPeriod_ns / 2;
    way_m_ += 0.5 * kStep_m;
  }
  void take_picture() { picture_ = hall_.seen_from({way_m_, 0.0, 0.0}); }
  void cover_lens() {
    covered_.assign(320 * 240, 8);
    picture_ = {covered_.data(), 320, 240, 320};
  }
  const StepOutput& deliver() {
    const WheelSample sample = {{time_ns_}, way_m_, way_m_};
    return slam_.step({{time_ns_}, picture_, {&sample, 1}, kMaxCorners});
  }
  void drive(int steps) {
    for (int i = 0; i < steps; ++i) {
      half_step();
      half_step();
      take_picture();
      deliver();
    }
  }
  double way_m() const { return way_m_; }
  const Slam& slam() const { return slam_; }

 private:
  MemoryBlock memory_;
  Slam slam_;
  Hall hall_;
  ImageView picture_;
  std::vector<std::uint8_t> covered_;
  std::int64_t time_ns_ = 1'000'000'000;
  double way_m_ = 0.0;
};

TEST(RepeatedFrames, OnesThatComeTwiceMoveNothing) {
  const TestSeed seed;
  Drive drive(seed.value());
  drive.drive(1);
  const double start_m = drive.way_m();
  constexpr int kSteps = 80;
  for (int i = 0; i < kSteps; ++i) {
    drive.half_step();
    EXPECT_TRUE(drive.deliver().repeated) << i;
    drive.half_step();
    drive.take_picture();
    EXPECT_FALSE(drive.deliver().repeated) << i;
  }
  const StepOutput& last = drive.slam().output();
  EXPECT_NEAR(last.T_start_robot.x_m, drive.way_m() - start_m, 0.02);
  EXPECT_NEAR(last.T_start_robot.y_m, 0.0, 0.02);
  EXPECT_GT(last.inliers, 20);
  const StepCounters counters = drive.slam().counters();
  EXPECT_EQ(counters.frames_repeated, std::uint64_t{kSteps});
  EXPECT_LT(counters.mapper.slips, 3u);
}

// The wheels go on alone.
TEST(RepeatedFrames, FrozenPictureLeavesThePoseToTheWheels) {
  const TestSeed seed;
  Drive drive(seed.value());
  drive.drive(60);
  const Pose2 before = drive.slam().output().T_start_robot;
  const std::uint64_t created = drive.slam().counters().mapper.landmarks_created;
  const double way_m = drive.way_m();
  for (int i = 0; i < 60; ++i) {
    drive.half_step();
    drive.half_step();
    ASSERT_TRUE(drive.deliver().repeated);
  }
  const Pose2 moved = before.inverse() * drive.slam().output().T_start_robot;
  EXPECT_NEAR(moved.x_m, drive.way_m() - way_m, 1e-6);
  EXPECT_NEAR(moved.theta_rad, 0.0, 1e-6);
  EXPECT_EQ(drive.slam().counters().mapper.landmarks_created, created);
  EXPECT_EQ(drive.slam().output().inliers, 0);
}

// No corners, no picture to repeat: of a covered lens all frames are alike.
TEST(RepeatedFrames, CoveredLensRepeatsNothing) {
  const TestSeed seed;
  Drive drive(seed.value());
  drive.drive(20);
  for (int i = 0; i < 20; ++i) {
    drive.half_step();
    drive.half_step();
    drive.cover_lens();
    EXPECT_FALSE(drive.deliver().repeated) << i;
  }
  EXPECT_EQ(drive.slam().counters().frames_repeated, 0u);
}

}  // namespace
}  // namespace zenith
