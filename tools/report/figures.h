#pragma once
// The figures by which a run is judged, from its log. What needs ground truth is empty without it.

#include <optional>
#include <string>
#include <vector>

#include "slam/geometry.h"
#include "tools/runner/run_log.h"

namespace zenith::tools {

// A merge is wrong when its transform is off by more than this.
inline constexpr double kWrongMerge_m = 0.5;
inline constexpr double kWrongMerge_rad = 5.0 * std::numbers::pi / 180.0;

// Fused landmarks this near to each other ought to be one.
inline constexpr double kDuplicateDistance_m = 0.05;

struct TransformError {
  double position_m = 0.0;
  double angle_rad = 0.0;
  bool wrong() const { return position_m > kWrongMerge_m || angle_rad > kWrongMerge_rad; }
};

// The error of the position when a robot comes back to where it started: before the start comes
// into sight, and when it has been passed.
struct ReturnFigures {
  double time_s = 0.0;
  double driven_m = 0.0;
  double before_m = 0.0;
  double after_m = 0.0;
  double percent() const { return 100.0 * before_m / driven_m; }  // of the way
};

// The last pose against the truth, in the start frame, and whether the stated covariance P is
// honest: e^T P^-1 e over (x, y, theta) is 3 on average when it is.
struct EndFigures {
  double position_m = 0.0;
  double angle_rad = 0.0;
  double stated_position_m = 0.0;  // root of the trace
  double stated_angle_rad = 0.0;
  double nees = 0.0;
};

struct StepTimes {
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

struct RobotFigures {
  std::string name;
  int frames = 0;
  double duration_s = 0.0;
  double path_m = 0.0;  // as estimated
  std::optional<double> true_path_m;
  std::optional<double> ate_m;
  std::optional<double> odometry_ate_m;
  std::optional<ReturnFigures> loop;
  std::optional<EndFigures> end;
  std::optional<int> jumps;        // of the online pose, see pose_jumps.h
  std::optional<int> wrong_jumps;  // of these
  StepTimes step;
  int landmarks = 0;
  std::optional<SetupVerdict> verdict;  // of the set-up, where the run said one
  SetupMeasures setup;                  // what it was judged by
};

// What `own` made of its transform with `peer`.
struct PairFigures {
  int own = 0;
  int peer = 0;
  int merges = 0;
  int withdrawn = 0;
  int false_merges = 0;  // merges that were wrong at their moment
  bool merged_at_end = false;
  std::optional<double> merge_time_s;  // of the first merge, since the pair's first frame
  std::optional<double> overlap_time_s;
  std::optional<double> driven_till_merge_m;  // by `own`, since the overlap began
  std::optional<TransformError> at_merge;
  std::optional<TransformError> later;  // 20 s after the first merge
  std::optional<TransformError> at_end;
  std::optional<TransformError> through_others;  // at the end, composed from others' merges
  std::optional<TransformError> round_trip;      // T_own_peer T_peer_own against the identity
  int fused = 0;                                 // landmarks that both hold, as one
  int duplicates = 0;                            // pairs that lie within 5 cm and are not one
};

struct TeamFigures {
  std::vector<RobotFigures> robots;
  std::vector<PairFigures> pairs;        // every ordered pair
  std::optional<TransformError> circle;  // three robots: a < b < c < a against the identity
};

TeamFigures judge(const TeamLog& log);

// True transform from the peer's start frame to the own one: empty without ground truth.
std::optional<Pose2> true_transform(const RobotLog& own, const RobotLog& peer);

TransformError transform_error(const Pose2& estimate, const Pose2& truth);

}  // namespace zenith::tools
