#pragma once
// Whether old landmarks in view say where the robot is: the search behind the closing of loops.
//
// An old landmark is one of the own map that was not seen for a long way (loop_travel_m). The
// recent ones tell a pose; the map's old part may lie elsewhere by the drift since. A hypothesis is
// a transform of the pose, in the start frame: T_old_recent times the pose by the recent landmarks
// is the pose by the old ones. The identity is always one of them: the pose holds as it is.
//
// A search, every kSearch_m of travel or kSearch_rad of turn:
//
//   test     each hypothesis against this frame: the old landmarks that it puts well inside the
//            image must be there, within kHit_px after the best correction of the pose
//   propose  similar corners of each old landmark, within what the drift allows, vote for
//            (forward, left, turn); peaks become hypotheses. A ceiling that repeats itself
//            gives several, which are each other's runners-up
//
// The best one is acted upon when it meets the standard (map/evidence.h) with the jump's
// probability after the drift in its score: -d^2 / 2, d the jump's Mahalanobis distance.

#include <array>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/closing_votes.h"
#include "slam/features.h"
#include "slam/map/association.h"
#include "slam/map/confidence.h"
#include "slam/map/evidence.h"
#include "slam/map/map.h"
#include "slam/parameters.h"

namespace zenith {

// One keyframe, before the particles move.
struct ClosingFrame {
  std::span<const Candidate> candidates;
  std::span<const Feature> features;
  const Map& map;
  const FeatureExtractor& view;
  Pose2 T_start_odometry;  // the pose for which the candidates were predicted
  PoseCorrection recent;   // of that pose, by the recent landmarks
  Eigen::Matrix3d drift;   // covariance of the jump, over (forward, left, turn)
  double travelled_m = 0.0;

  Pose2 T_start_recent() const {
    return T_start_odometry * Pose2{recent.xi.x(), recent.xi.y(), recent.xi.z()};
  }
};

// Median over the promoted inliers of Map::drift_travel_m(); 0 when there are none.
double median_drift(std::span<const Candidate> candidates, const Map& map);

// Where the old landmarks say that the robot is.
struct Closing {
  // Of T_start_odometry: over the searches, and by this frame alone.
  PoseCorrection correction;
  PoseCorrection in_frame;
  Pose2 T_old_recent;
  double drift_travel_m = 0.0;  // median over the matches: Map::drift_travel_m()
};

class ClosingSearch {
 public:
  void layout(Arena& arena);
  void build(const Parameters& parameters);
  void reset();

  // True: `out` can be acted upon; matches() are the landmarks that say so.
  bool update(const ClosingFrame& frame, Associator& associator, Closing& out);
  std::span<const Candidate> matches() const { return tested_[0].span(); }

  // The pose has been moved by `T_old_recent`.
  void moved(const Pose2& T_old_recent) { moved({}, T_old_recent); }
  // Old map and pose have been moved, each by its own transform of the start frame.
  void moved(const Pose2& old_by, const Pose2& pose_by);

 private:
  struct Hypothesis {
    Pose2 T_old_recent;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of the jump, in the body
    Evidence evidence;
    Confidence confidence;
    double jump2 = 0.0;  // squared Mahalanobis distance of the jump, after the drift
    bool used = false;
  };
  struct Test {
    Support support;
    PoseCorrection correction;  // of the odometry's pose
    Pose2 T_old_recent;
    bool fixed = false;  // matches enough to fix the pose
  };
  static constexpr int kHypotheses = 8;
  static constexpr int kPeaks = 5;

  Test test(const ClosingFrame& frame, const Pose2& T_old_recent, Associator& associator);
  Support count_support(const ClosingFrame& frame) const;
  void search(const ClosingFrame& frame, Associator& associator);
  bool meets_old_map(const ClosingFrame& frame);
  void join_same(const ClosingFrame& frame);
  void propose(const ClosingFrame& frame, Associator& associator);
  void add(const ClosingFrame& frame, const Pose2& T_old_recent, Associator& associator);
  void record(const ClosingFrame& frame, Hypothesis& h, const Test& t);
  void fuse(const ClosingFrame& frame, Hypothesis& h, const Test& t);
  void ensure_identity(const ClosingFrame& frame);
  Hypothesis& place_for_one();
  double score(const Hypothesis& h) const;
  bool same(const Pose2& a, const Pose2& b, const ClosingFrame& frame) const;
  int best() const;
  bool convincing(int best, const ClosingFrame& frame) const;

  double pixel_ = 0.0;  // of the rectified image, normalised
  double gate_sigma_ = 0.0;
  float ncc_min_ = 0.0F;
  int min_inliers_ = 0;
  std::array<Hypothesis, kHypotheses> hypotheses_ = {};
  bool accepted_ = false;
  double searched_at_m_ = 0.0;
  double searched_heading_rad_ = 0.0;
  double met_at_m_ = 0.0;  // old landmarks were in view
  double rho_ = 1.0;       // mean inverse height of the old landmarks in view
  std::span<Candidates> tested_;
  std::array<bool, kMaxCorners> corner_used_ = {};
  ClosingVotes votes_;
};

}  // namespace zenith
