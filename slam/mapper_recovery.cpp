// When a frame does not fit where the wheels lead: the search around that place, waiting, and the
// search in the whole map. Wheels that slip, robots that are pushed or carried.

#include <algorithm>
#include <cmath>

#include "slam/mapper.h"

namespace zenith {
namespace {

constexpr int kWellInside_px = 24;
constexpr int kEstablishedObservations = 10;
// The search around the wheels' pose: it grows with what the wheels turned since the last fix.
constexpr double kSearchRadius_m = 0.8;
constexpr double kSearchTurn_rad = 1.1;
// What a pose must show to be gone on from: hits, their share of what is expected, and no rival.
constexpr int kLeastHits = 10;
constexpr double kLeastShare = 0.5;
constexpr double kRivalShare = 0.7;
// Of a pose found by one frame.
const Eigen::Vector3d kFoundSigma(0.04, 0.04, 0.02);
constexpr double kSeenAgain_m = 6.0;
// A push: of the corners kept, fewer than this share are within kSameCorner_px of one.
constexpr double kSameCorner_px = 3.0;
constexpr double kSameShare = 0.5;
constexpr std::size_t kEnoughCorners = 12;
constexpr int kFewCorners = 12;  // of a frame that shows too little to be judged

}  // namespace

MatchShare Mapper::match_share() const {
  MatchShare share;
  for (const Candidate& c : candidates_[0]) {
    const LandmarkInfo& l = map_->info(c.slot);
    share.agreeing += c.promoted && c.inlier ? 1 : 0;
    share.recent += c.promoted && !c.old ? 1 : 0;
    if (c.old || !c.well_inside || !is_reliable(l)) continue;
    if (l.observations < kEstablishedObservations) continue;
    ++share.expected;
    share.matched += c.inlier ? 1 : 0;
  }
  return share;
}

bool Mapper::follow(const Features& features, const FeatureExtractor& view) {
  const bool lost = tracking_.state() == TrackingState::kLost;
  if (!lost) match(features, view);
  if (map_ != &own_map_ || first_) return true;
  // A covered lens, or darkness: nothing contradicts the wheels.
  const auto corners =
      std::count_if(features.begin(), features.end(), [](const Feature& f) { return f.described; });
  if (!lost && corners < kFewCorners) return true;
  if (!lost && (loop_closing_ || !Tracking::is_weak(match_share()))) {
    tracking_.follow();
    return true;
  }
  const FrameOverMap frame = {features, *map_, view, lever_m(), robot_.mount.z_m, pixel_};
  if (lost ? relocalise(frame) : recover(frame)) {
    tracking_.follow();
    return true;
  }
  ++counters_.frames_held;
  if (lost) return false;
  tracking_.hold(std::hypot(moved_.x_m, moved_.y_m));
  if (tracking_.state() == TrackingState::kLost) {
    ++counters_.times_lost;
    relocaliser_.reset();
  }
  return false;
}

// The frame's own place near where the wheels lead, whatever they say of the way there.
bool Mapper::recover(const FrameOverMap& frame) {
  const SearchArea area = {pose_.mean, kSearchRadius_m + 0.5 * tracking_.held_m(), kSearchTurn_rad};
  PoseSearch::Poses poses;
  search_.find(frame, area, poses);
  if (poses.empty()) return false;
  const PoseEvidence& best = poses[0];
  if (best.hits < kLeastHits || best.share() < kLeastShare) return false;
  if (poses.size() > 1 && poses[1].hits > kRivalShare * best.hits) return false;
  if (!continue_at(frame, best.T_own_robot)) return false;
  ++counters_.poses_recovered;
  return true;
}

bool Mapper::relocalise(const FrameOverMap& frame) {
  const auto found = relocaliser_.step(frame, moved_, search_);
  if (!found) return false;
  if (!continue_at(frame, *found)) return false;
  ++counters_.relocalised;
  return true;
}

// Moves all poses there and matches anew. When the filter's own prediction does not fit either, all
// is as it was.
bool Mapper::continue_at(const FrameOverMap& frame, const Pose2& T_own_robot) {
  const Pose2 by = pose_.mean.inverse() * T_own_robot;
  const Eigen::Matrix3d before = motion_.covariance;
  shift_poses(by);
  note_as_seen(T_own_robot);
  motion_.covariance = kFoundSigma.cwiseAbs2().asDiagonal();
  match(frame.features, frame.view);
  const MatchShare share = match_share();
  if (share.matched >= kLeastHits && !Tracking::is_weak(share)) return true;
  motion_.covariance = before;
  shift_poses(by.inverse());
  return false;
}

// Landmarks around: they are no old ones, of which drift would make others than they are.
void Mapper::note_as_seen(const Pose2& T_own_robot) {
  for (LandmarkInfo& l : map_->landmarks()) {
    if (l.state != LandmarkState::kPromoted) continue;
    const Eigen::Vector2d off = l.position_m().head<2>() - T_own_robot.position();
    if (off.norm() < kSeenAgain_m) l.last_seen_way_m = map_->way_m();
  }
}

void Mapper::shift_poses(const Pose2& by) {
  closing_search_.reset();  // what it has found is of another pose
  const Pose2 before = pose_.mean;
  for (int i = 0; i < particles_.count; ++i) particles_.set_pose(i, particles_.pose(i) * by);
  check_poses();
  place_cameras(particles_, lever_m());
  pose_ = estimate_pose(particles_);
  pose_by_calibration_.row(0) -= (pose_.mean.y_m - before.y_m) * pose_by_calibration_.row(2);
  pose_by_calibration_.row(1) += (pose_.mean.x_m - before.x_m) * pose_by_calibration_.row(2);
}

void Mapper::hold() {
  wait_for_landmarks();
  scale_.reset();
  estimate();
  corners_kept_.clear();
}

void Mapper::keep_corners(const Features& features) {
  corners_kept_.clear();
  for (const Candidate& c : candidates_[0]) {
    if (!c.inlier || !c.well_inside) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    corners_kept_.push_back({f.zx, f.zy});
  }
}

bool Mapper::sees_push(const Features& features) const {
  if (tracking_.state() == TrackingState::kHeld) return true;
  if (corners_kept_.size() < kEnoughCorners) return false;
  const auto radius = static_cast<float>(kSameCorner_px * pixel_);
  const auto stays = [&](const Eigen::Vector2f& kept) {
    return std::any_of(features.begin(), features.end(), [&](const Feature& f) {
      return (Eigen::Vector2f(f.zx, f.zy) - kept).squaredNorm() < radius * radius;
    });
  };
  const auto same = std::count_if(corners_kept_.begin(), corners_kept_.end(), stays);
  return static_cast<double>(same) < kSameShare * static_cast<double>(corners_kept_.size());
}

}  // namespace zenith
