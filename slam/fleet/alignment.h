#pragma once
// What readers of the fleet get: landmarks, alignments with peers, the pairs that hold them.

#include <cstdint>

#include <Eigen/Core>

#include "slam/geometry.h"

namespace zenith {

struct LandmarkEstimate {
  std::uint32_t id = 0;
  Eigen::Vector3d position_m;  // in the robot's own start frame
  Eigen::Matrix3d covariance_m2;
  int observations = 0;
};

enum class AlignmentState { kCandidate, kMerged, kWithdrawn };

// As files and telemetry say it.
constexpr const char* state_name(AlignmentState state) {
  if (state == AlignmentState::kMerged) return "merged";
  return state == AlignmentState::kWithdrawn ? "withdrawn" : "candidate";
}

// The transform that takes peer's coordinates into the robot's own start frame.
struct Alignment {
  int peer = 0;  // slot, as given to receive()
  AlignmentState state = AlignmentState::kCandidate;
  Pose2 T_own_peer;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // over (x, y, theta)
  double confidence = 0.0;                               // Eq. 4, corrected
  int correspondences = 0;
};

struct Correspondence {
  std::uint32_t own_id = 0;
  std::uint32_t peer_id = 0;
};

// A landmark of the common map.
struct FusedLandmark {
  LandmarkEstimate landmark;
  int owners = 1;   // robots that hold it
  int source = -1;  // -1: own (possibly fused); otherwise the peer's slot
};

}  // namespace zenith
