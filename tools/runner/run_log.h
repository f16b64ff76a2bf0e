#pragma once
// What a run of a team leaves behind: plain data, from which figures, files and pictures are made.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "platform/base/memory_table.h"
#include "platform/base/time.h"
#include "slam/geometry.h"
#include "slam/joint.h"
#include "slam/slam.h"

namespace zenith::tools {

// A robot's view of one peer after one frame.
struct PeerLog {
  int peer = 0;  // the robot's index in the team
  AlignmentState state = AlignmentState::kCandidate;
  Pose2 T_own_peer;
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();  // of x, y, theta
  double confidence = 0.0;
  int correspondences = 0;
};

struct FrameLog {
  Time stamp;
  Pose2 T_start_robot;         // the estimate
  Pose2 odometry;              // dead reckoning alone, from the first frame
  std::optional<Pose2> truth;  // T_world_robot
  double step_s = 0.0;         // wall time of the step
  int corners = 0;
  int candidates = 0;
  int matched = 0;
  int inliers = 0;
  double effective_sample_size = 0.0;
  Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero();
  std::vector<PeerLog> peers;
};

struct RobotLog {
  std::string name;
  std::vector<FrameLog> frames;
  StepCounters counters;
  SetupVerdict verdict;
  SetupMeasures setup;
  double corner_sigma_px = 0.0;  // of the last step
  MemoryTable memory;            // of its Slam
  std::vector<LandmarkEstimate> landmarks;
  std::vector<FusedLandmark> fused;                          // `source` is a slot, see peer_of_slot
  std::vector<std::vector<Correspondence>> correspondences;  // by the peer's index in the team
};

// A filter that joined another one.
struct JoinLog {
  int host = 0;
  int guest = 0;
  Time stamp;  // of the host's frame
  Pose2 T_host_guest;
  int common_landmarks = 0;
  int imported_landmarks = 0;
};

// What robots in one filter did, see slam/joint.h.
struct JointLog {
  std::vector<JoinLog> joins;
  JointCounters counters;
};

struct TeamLog {
  std::vector<RobotLog> robots;
  std::optional<JointLog> joint;  // of a joint run
};

// Slots count the other robots in the team's order.
inline int slot_of_peer(int own, int peer) {
  return peer < own ? peer : peer - 1;
}
inline int peer_of_slot(int own, int slot) {
  return slot < own ? slot : slot + 1;
}

// The view of `peer` in this frame, or nullptr.
inline const PeerLog* find_peer(const FrameLog& frame, int peer) {
  for (const PeerLog& log : frame.peers) {
    if (log.peer == peer) return &log;
  }
  return nullptr;
}

}  // namespace zenith::tools
