#include "tools/report/pose_jumps.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/tools/synthetic_log.h"
#include "tools/report/figures.h"

namespace zenith::tools {
namespace {

// The estimate is off by `error` from frame `from` to frame `to`, in its own start frame.
void displace(TeamLog& team, const Pose2& error, int from, int to) {
  auto& frames = team.robots[0].frames;
  for (int i = from; i < to; ++i) {
    Pose2& pose = frames[static_cast<std::size_t>(i)].T_start_robot;
    pose = pose * error;
  }
}

TEST(PoseJumps, NoneInAPerfectRun) {
  const TeamLog team = synthetic_team();
  EXPECT_TRUE(find_jumps(team.robots[0].frames).empty());
}

TEST(PoseJumps, SmallOnesAreNone) {
  TeamLog team = synthetic_team();
  displace(team, {0.04, 0.0, 0.015}, 100, 600);
  EXPECT_TRUE(find_jumps(team.robots[0].frames).empty());
}

TEST(PoseJumps, WrongWhereTheErrorGrows) {
  TeamLog team = synthetic_team();
  displace(team, {0.06, 0.0, 0.0}, 100, 600);
  displace(team, {0.0, 0.0, 0.02}, 300, 600);
  const auto jumps = find_jumps(team.robots[0].frames);
  ASSERT_EQ(jumps.size(), 2U);
  EXPECT_EQ(jumps[0].frame, 100U);
  EXPECT_NEAR(jumps[0].position_m, 0.06, 1e-9);
  EXPECT_TRUE(jumps[0].wrong);
  EXPECT_EQ(jumps[1].frame, 300U);
  EXPECT_NEAR(jumps[1].angle_rad, 0.02, 1e-9);
  EXPECT_TRUE(jumps[1].wrong);
}

// A drift that becomes visible, and goes at once.
TEST(PoseJumps, RightWhereTheErrorShrinks) {
  TeamLog team = synthetic_team();
  for (int i = 100; i < 300; ++i) displace(team, {0.001 * (i - 99), 0.0, 0.0}, i, i + 1);
  const auto jumps = find_jumps(team.robots[0].frames);
  ASSERT_EQ(jumps.size(), 1U);
  EXPECT_EQ(jumps[0].frame, 300U);
  EXPECT_FALSE(jumps[0].wrong);
  const RobotFigures figures = judge(team).robots[0];
  EXPECT_EQ(figures.jumps, 1);
  EXPECT_EQ(figures.wrong_jumps, 0);
}

// To the right place and back: both are wrong, the first for it is undone.
TEST(PoseJumps, WrongWhereTheyAreUndone) {
  TeamLog team = synthetic_team();
  for (int i = 100; i < 600; ++i)
    displace(team, {0.001 * std::min(i - 99, 100), 0.0, 0.0}, i, i + 1);
  displace(team, {-0.1, 0.0, 0.0}, 400, 403);
  const auto jumps = find_jumps(team.robots[0].frames);
  ASSERT_EQ(jumps.size(), 2U);
  EXPECT_EQ(jumps[0].frame, 400U);
  EXPECT_EQ(jumps[1].frame, 403U);
  EXPECT_TRUE(jumps[0].wrong);
  EXPECT_TRUE(jumps[1].wrong);
}

TEST(PoseJumps, NothingIsSaidWithoutGroundTruth) {
  TeamLog team = synthetic_team();
  displace(team, {0.06, 0.0, 0.0}, 100, 600);
  team.robots[0].frames[300].truth.reset();
  EXPECT_TRUE(find_jumps(team.robots[0].frames).empty());
  EXPECT_FALSE(judge(team).robots[0].jumps.has_value());
}

}  // namespace
}  // namespace zenith::tools
