#pragma once
// A made-up run of two robots that drive along one line, for tests of figures and outputs: 1 m/s,
// 10 frames a second, 60 s; b starts 20 m ahead of a, turned by a right angle.

#include <numbers>

#include "tools/runner/run_log.h"

namespace zenith::tools {

inline constexpr int kSyntheticFrames = 600;

inline Pose2 synthetic_truth(int robot, int frame) {
  const double x = 0.1 * frame + 20.0 * robot;
  return {x, 0.0, 0.5 * std::numbers::pi * robot};
}

// T_a_b and T_b_a as they are.
inline Pose2 synthetic_transform(int own) {
  const Pose2 peer = synthetic_truth(1 - own, 0);
  return synthetic_truth(own, 0).inverse() * peer;
}

// Without any alignment.
inline TeamLog synthetic_team() {
  TeamLog team;
  for (int robot = 0; robot < 2; ++robot) {
    RobotLog log;
    log.name = robot == 0 ? "a" : "b";
    log.memory.add("rows", 900);
    log.memory.add("looks", 100);
    log.correspondences.resize(2);
    for (int i = 0; i < kSyntheticFrames; ++i) {
      FrameLog frame;
      frame.stamp = {1'000'000'000 + i * 100'000'000LL};
      frame.truth = synthetic_truth(robot, i);
      frame.T_start_robot = synthetic_truth(robot, 0).inverse() * *frame.truth;
      frame.odometry = frame.T_start_robot;
      frame.step_s = 0.001 * (1 + i % 100);
      log.frames.push_back(frame);
    }
    team.robots.push_back(std::move(log));
  }
  return team;
}

// `own` sees `peer` in this state, with this transform, in the frames [from, to).
inline void add_alignment(RobotLog& robot, int peer, AlignmentState state, const Pose2& T, int from,
                          int to) {
  for (int i = from; i < to; ++i) {
    PeerLog view;
    view.peer = peer;
    view.state = state;
    view.T_own_peer = T;
    view.variance = {1e-4, 2e-4, 3e-4};
    view.confidence = state == AlignmentState::kMerged ? 0.8 : 0.3;
    view.correspondences = 20;
    robot.frames[static_cast<std::size_t>(i)].peers = {view};
  }
}

}  // namespace zenith::tools
