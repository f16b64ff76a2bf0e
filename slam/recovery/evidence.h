#pragma once
// What one frame says for a pose in the own map: of the landmarks that must be in view from there,
// how many are found where they must be. Asked of any pose: needs no prediction by the filter.

#include "slam/features.h"
#include "slam/geometry.h"
#include "slam/map/map.h"

namespace zenith {

// A frame over a map, for all poses that may be asked of.
struct FrameOverMap {
  const Features& features;
  const Map& map;
  const FeatureExtractor& view;
  Eigen::Vector2d lever_m;  // of the camera in base_link
  double camera_z_m = 0.0;
  double pixel = 0.0;  // of the rectified image, normalised
};

// Of landmarks that were seen whenever they were in view.
struct PoseEvidence {
  int expected = 0;
  int hits = 0;
  Pose2 T_own_robot;  // on which the hits agree; as asked when they are too few
  double share() const { return expected == 0 ? 0.0 : static_cast<double>(hits) / expected; }
};

// `T_own_robot` may be off by a hand's breadth and some degrees.
PoseEvidence evidence_at(const FrameOverMap& frame, const Pose2& T_own_robot);

// Promoted, and found in most frames in which it was in view.
bool is_reliable(const LandmarkInfo& landmark);

}  // namespace zenith
