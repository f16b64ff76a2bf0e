// A peer that lies harms nobody's trajectory: what others tell never enters the own map.

#include <array>
#include <span>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "slam/slam.h"
#include "tools/runner/simulated_source.h"

namespace zenith {
namespace {

struct Robot {
  explicit Robot(const RobotConfig& config)
      : memory(Slam::memory_needed({})), slam(config, {}, 7, memory.span()) {}

  MemoryBlock memory;
  Slam slam;
};

// The worst that somebody with the key can do: it tells the robot's own landmarks as if it had seen
// them from another start, so that the maps fit, and from then on where they are not.
class Liar {
 public:
  LandmarkRecord twist(const LandmarkRecord& truth, bool trusted) {
    LandmarkRecord r = truth;
    const Eigen::Vector2d at = T_liar_robot_ * Eigen::Vector2d(truth.x_m, truth.y_m);
    r.x_m = static_cast<float>(at.x() + (trusted ? 1.5 : 0.0));
    r.y_m = static_cast<float>(at.y() - (trusted ? 0.8 : 0.0));
    r.covariance_m2 = {1e-6F, 0.0F, 0.0F, 1e-6F, 0.0F, 1e-6F};  // and is quite sure of it
    r.observations = 60000;
    for (std::size_t i = 0; i < r.appearance_count; ++i) {
      r.appearances[i].direction_rad =
          static_cast<float>(wrap_angle(r.appearances[i].direction_rad + T_liar_robot_.theta_rad));
    }
    return r;
  }
  Pose2 T_robot_liar() const { return T_liar_robot_.inverse(); }

 private:
  Pose2 T_liar_robot_{3.0, -2.0, 0.9};
};

TEST(LyingPeer, LeavesEveryPoseAsItWouldBeWithoutIt) {
  auto team = tools::simulate_team("corridor-rooms", 3, 24.0, {});
  ASSERT_TRUE(team.ok()) << team.error().message;
  Source& source = *team->sources[0];
  const Lens& lens = source.config().lens;
  Robot alone(source.config());
  Robot lied_to(source.config());
  Liar liar;
  std::array<LandmarkRecord, 256> records;
  bool merged = false;
  int frames = 0;
  SourceFrame frame;
  for (auto more = source.next(frame); more.ok() && *more; more = source.next(frame)) {
    StepInput input;
    input.stamp = frame.stamp;
    input.frame = {frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
    input.wheels = frame.wheels;
    const StepOutput& honest = alone.slam.step(input);
    const StepOutput& misled = lied_to.slam.step(input);
    ++frames;
    ASSERT_EQ(honest.T_start_robot.x_m, misled.T_start_robot.x_m) << "frame " << frames;
    ASSERT_EQ(honest.T_start_robot.y_m, misled.T_start_robot.y_m) << "frame " << frames;
    ASSERT_EQ(honest.T_start_robot.theta_rad, misled.T_start_robot.theta_rad) << frames;
    ASSERT_EQ(honest.pose_covariance, misled.pose_covariance) << "frame " << frames;

    alone.slam.publish(records);
    const std::size_t count = lied_to.slam.publish(records);
    for (std::size_t i = 0; i < count; ++i) records[i] = liar.twist(records[i], merged);
    lied_to.slam.receive(0, std::span(records).first(count));
    lied_to.slam.offer_alignment(0, liar.T_robot_liar());
    for (const Alignment& a : lied_to.slam.alignments()) {
      merged = merged || a.state == AlignmentState::kMerged;
    }
  }
  EXPECT_GT(frames, 200);
  EXPECT_TRUE(merged) << "the liar was not even believed: this test shows nothing";
}

}  // namespace
}  // namespace zenith
