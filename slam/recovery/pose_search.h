#pragma once
// Where in its own map may the robot be, by one frame alone? The search for overlaps
// (fleet/hough.h) over the own landmarks. The frame's corners have no heights; each pair of a
// corner and a landmark takes the landmark's.

#include <limits>
#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/hough.h"
#include "slam/recovery/evidence.h"

namespace zenith {

// What is searched: poses so near to another one. As it stands: all.
struct SearchArea {
  Pose2 around;
  double radius_m = std::numeric_limits<double>::infinity();
  double turn_rad = 4.0;
};

class PoseSearch {
 public:
  void layout(Arena& arena);

  // Possible poses with the evidence for each, the most hits first. Poses nearer to each other than
  // the Hough search tells apart are one.
  using Poses = FixedVector<PoseEvidence, kMaxPeaks>;
  void find(const FrameOverMap& frame, const SearchArea& area, Poses& out);

 private:
  void find_matches(const FrameOverMap& frame, const SearchArea& area);

  HoughSearch hough_;
  std::span<OverlapMatches> matches_;
  std::span<PlaceFixes> fixes_;
  std::span<BestMatches> best_;
};

}  // namespace zenith
