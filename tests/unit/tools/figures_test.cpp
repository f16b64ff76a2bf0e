#include "tools/report/figures.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/tools/synthetic_log.h"

namespace zenith::tools {
namespace {

TEST(Figures, OfAPerfectRun) {
  TeamLog team = synthetic_team();
  const TeamFigures figures = judge(team);
  ASSERT_EQ(figures.robots.size(), 2U);
  const RobotFigures& a = figures.robots[0];
  EXPECT_EQ(a.frames, 600);
  EXPECT_NEAR(a.path_m, 59.9, 1e-9);
  EXPECT_NEAR(*a.true_path_m, 59.9, 1e-9);
  EXPECT_NEAR(*a.ate_m, 0.0, 1e-9);
  EXPECT_NEAR(a.duration_s, 59.9, 1e-9);
  EXPECT_FALSE(a.loop.has_value());
  EXPECT_NEAR(a.step.max_ms, 100.0, 1e-9);
  EXPECT_NEAR(a.step.median_ms, 51.0, 1.0);
  EXPECT_NEAR(a.step.p95_ms, 95.0, 1.0);
  for (const PairFigures& pair : figures.pairs) {
    EXPECT_EQ(pair.merges, 0);
    EXPECT_FALSE(pair.at_end.has_value());
    EXPECT_FALSE(pair.merge_time_s.has_value());
  }
}

TEST(Figures, OfAMerge) {
  TeamLog team = synthetic_team();
  Pose2 near = synthetic_transform(0);
  add_alignment(team.robots[0], 1, AlignmentState::kCandidate, near, 200, 250);
  near.x_m += 0.3;
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, near, 250, 400);
  near.x_m -= 0.2;
  near.theta_rad += 0.01;
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, near, 400, 600);
  const PairFigures pair = judge(team).pairs[0];
  EXPECT_EQ(pair.own, 0);
  EXPECT_EQ(pair.peer, 1);
  EXPECT_EQ(pair.merges, 1);
  EXPECT_EQ(pair.withdrawn, 0);
  EXPECT_EQ(pair.false_merges, 0);
  EXPECT_TRUE(pair.merged_at_end);
  EXPECT_NEAR(*pair.merge_time_s, 25.0, 1e-9);
  // a comes within 1.5 m of b's start, 20 m ahead, after 18.6 s.
  EXPECT_NEAR(*pair.overlap_time_s, 18.6, 0.11);
  EXPECT_NEAR(*pair.driven_till_merge_m, 6.4, 0.11);
  EXPECT_NEAR(pair.at_merge->position_m, 0.3, 1e-9);
  EXPECT_NEAR(pair.later->position_m, 0.1, 1e-9);
  EXPECT_NEAR(pair.at_end->position_m, 0.1, 1e-9);
  EXPECT_NEAR(pair.at_end->angle_rad, 0.01, 1e-9);
  EXPECT_FALSE(pair.at_end->wrong());
}

TEST(Figures, OfAWrongMergeThatIsWithdrawn) {
  TeamLog team = synthetic_team();
  Pose2 wrong = synthetic_transform(1);
  wrong.theta_rad += 0.2;
  add_alignment(team.robots[1], 0, AlignmentState::kMerged, wrong, 100, 150);
  add_alignment(team.robots[1], 0, AlignmentState::kWithdrawn, wrong, 150, 180);
  add_alignment(team.robots[1], 0, AlignmentState::kMerged, synthetic_transform(1), 350, 600);
  const PairFigures pair = judge(team).pairs[1];
  EXPECT_EQ(pair.own, 1);
  EXPECT_EQ(pair.merges, 2);
  EXPECT_EQ(pair.withdrawn, 1);
  EXPECT_EQ(pair.false_merges, 1);
  EXPECT_TRUE(pair.at_merge->wrong());
  EXPECT_FALSE(pair.later.has_value()) << "20 s after the first merge nothing is merged";
  EXPECT_NEAR(pair.at_end->position_m, 0.0, 1e-9);
  EXPECT_FALSE(pair.overlap_time_s.has_value()) << "b never comes where a has been";
}

TEST(Figures, RoundTripOfTwoViews) {
  TeamLog team = synthetic_team();
  Pose2 off = synthetic_transform(1);
  off.x_m += 0.25;
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, synthetic_transform(0), 300, 600);
  add_alignment(team.robots[1], 0, AlignmentState::kMerged, off, 300, 600);
  const TeamFigures figures = judge(team);
  EXPECT_NEAR(figures.pairs[0].round_trip->position_m, 0.25, 1e-9);
  EXPECT_FALSE(figures.circle.has_value()) << "two robots make no circle";
}

TEST(Figures, DuplicatesAreNearPairsOfTwoOwners) {
  TeamLog team = synthetic_team();
  add_alignment(team.robots[0], 1, AlignmentState::kMerged, synthetic_transform(0), 300, 600);
  const auto add = [&](double x, int source) {
    FusedLandmark mark;
    mark.landmark.position_m = {x, 0.0, 2.5};
    mark.landmark.covariance_m2.setIdentity();
    mark.source = source;
    team.robots[0].fused.push_back(mark);
  };
  add(0.0, -1);
  add(1.0, -1);
  add(1.01, -1);  // both own: two things
  add(0.04, 0);   // 4 cm from the first: one thing, left double
  add(1.2, 0);
  team.robots[0].correspondences[1] = {{1, 1}, {2, 2}};
  const PairFigures pair = judge(team).pairs[0];
  EXPECT_EQ(pair.duplicates, 1);
  EXPECT_EQ(pair.fused, 2);
}

TEST(Figures, ReturnToTheStart) {
  // A circle of 10 m radius, the estimate stretched by 1 %.
  TeamLog team;
  team.robots.resize(1);
  constexpr int kFrames = 720;
  for (int i = 0; i < kFrames; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / (kFrames - 40);
    FrameLog frame;
    frame.stamp = {i * 100'000'000LL};
    frame.truth = Pose2{10.0 * std::sin(angle), 10.0 - 10.0 * std::cos(angle), angle};
    frame.T_start_robot = *frame.truth;
    frame.T_start_robot.x_m *= 1.01;
    team.robots[0].frames.push_back(frame);
  }
  const auto loop = judge(team).robots[0].loop;
  ASSERT_TRUE(loop.has_value());
  EXPECT_NEAR(loop->driven_m, 2.0 * std::numbers::pi * 10.0 - 5.05, 0.2);
  EXPECT_NEAR(loop->before_m, 0.01 * 4.84, 0.003);
  EXPECT_LT(loop->after_m, 0.02);
}

TEST(Figures, WithoutTruthOrFrames) {
  TeamLog team = synthetic_team();
  for (FrameLog& frame : team.robots[0].frames) frame.truth.reset();
  team.robots[1].frames.clear();
  const TeamFigures figures = judge(team);
  EXPECT_FALSE(figures.robots[0].ate_m.has_value());
  EXPECT_EQ(figures.robots[1].frames, 0);
  EXPECT_NEAR(figures.robots[0].path_m, 59.9, 1e-9);
}

}  // namespace
}  // namespace zenith::tools
