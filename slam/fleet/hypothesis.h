#pragma once
// One possible alignment with a peer, and what speaks for and against it (paper-notes, P17).
//
// A hypothesis begins with a place that the Hough search found, and is then tested by every further
// frame: where it says that peer's landmarks are, similar ones must be. It keeps the pairs of
// landmarks that it found and re-estimates the transform from all of them.

#include <cstdint>

#include "platform/base/fixed_vector.h"
#include "slam/fleet/align.h"
#include "slam/fleet/landmark_pairs.h"
#include "slam/fleet/overlap.h"
#include "slam/map/confidence.h"
#include "slam/map/evidence.h"
#include "slam/map/map.h"

namespace zenith {

// How often an expected landmark is found under the right alignment, and under a wrong one where
// the ceiling repeats itself. Measured on the simulated worlds: 0.86 to 0.98, and 0.3 to 0.65 (0.8
// to 0.89 where it repeats strictly, which is for the runners-up to expose). A wrong one finds
// similar appearances too, so a miss says much more than a hit.
inline constexpr HitRates kAlignmentHits = {0.9, 0.6};

struct Hypothesis {
  Pose2 T_own_peer;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double scatter = 1.0;  // mean squared distance of the pairs, per residual
  Confidence confidence;
  PairList pairs;
  // Hit: an observed landmark with a similar one of the peer where it should be. Expected: one
  // where the peer has any landmark of that height near.
  Evidence evidence;

  int hits() const { return evidence.sum().hits; }
  int expected() const { return evidence.sum().expected; }
  double score() const { return evidence.score(kAlignmentHits); }
};

struct TestSettings {
  float ncc_min = 0.60F;
  double radius_m = 0.15;
  double max_turn_rad = 0.5;
  double height_tolerance_m = 0.15;
};

// Tests the hypothesis against one frame: adds pairs, fills `place` with the pairs of this frame
// alone (peer_slot by observed) and returns the verdict.
struct FrameTest {
  Support support;
  Pose2 T_peer_robot;  // from this frame's pairs alone
  bool found = false;
};
FrameTest test_hypothesis(Hypothesis& hypothesis, const ObservedFrame& frame, const PeerMap& peer,
                          const Pose2& T_own_robot, const TestSettings& settings);

// Re-estimates the transform from all pairs (Eq. 7), the own side read from the map as it is now;
// forgets pairs whose own landmark is gone or that lie far off.
void refit(Hypothesis& hypothesis, const Map& map, const PeerMap& peer);

// Adds the pair, or confirms it; a landmark's stronger partner wins. False when full.
bool confirm_pair(Hypothesis& hypothesis, const LandmarkPair& pair);

// Whether two alignments are the same one, for a robot near `at` (own frame).
bool same_alignment(const Pose2& a, const Pose2& b, const Eigen::Vector2d& at);

}  // namespace zenith
