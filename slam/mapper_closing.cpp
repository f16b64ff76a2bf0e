// What becomes of a closing (closing.h): old landmarks that agree with the pose are used like all
// others; old landmarks that tell another pose move the robot, or are moved.
//
// Which of them, the drift travel says: the travel whose drift lies between a pose, or an anchor,
// and the map's start. It grows with the travel and is taken over from the landmarks in view, so
// that it is short again after a closing. The side with the shorter one stays.
//
//   the robot goes   by steps of at most kStep_m and kStep_rad a frame, with all that was mapped
//                    since the old landmarks went out of sight, rigidly. The last step is drawn:
//                    each particle finds its own place in its own old map, and takes its recent
//                    map along. After it both agree, so that nothing undoes it
//   the old map      comes at once: the part within kPiece_m of drift travel around what is in view
//
// In a joint filter other robots rely on the same anchors: no part of the map is moved.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/mapper.h"

namespace zenith {
namespace {

constexpr int kFewest = 8;
constexpr double kVisible2 = 16.0;  // squared Mahalanobis distance of a jump
constexpr double kVisible_m = 0.01;
constexpr double kVisible_rad = 0.15 * std::numbers::pi / 180.0;
constexpr double kStep_m = 0.025;  // a jump goes in steps of at most so much, one a frame
constexpr double kStep_rad = 0.4 * std::numbers::pi / 180.0;
constexpr double kPiece_m = 10.0;  // of travel on each side: what is moved together
constexpr double kClear_m = 5.0;   // a smaller difference of drift travel decides nothing
constexpr double kEverything_m = 1e9;
// Of a pose that old landmarks alone fix.
const Eigen::Vector3d kFree(0.1, 0.1, 3.0 * std::numbers::pi / 180.0);
constexpr double kViewTravel_m = 3.0;  // about what lies between the robot and what it sees

Pose2 pose_of(const Eigen::Vector3d& xi) {
  return {xi.x(), xi.y(), xi.z()};
}

Eigen::Vector3d vector_of(const Pose2& pose) {
  return {pose.x_m, pose.y_m, pose.theta_rad};
}

// A turn about `at`, and a shift.
Pose2 moved_about(const Eigen::Vector2d& at, const Eigen::Vector3d& by) {
  return Pose2{at.x() + by.x(), at.y() + by.y(), by.z()} * Pose2{-at.x(), -at.y(), 0.0};
}

}  // namespace

// Covariance of a jump, in the body: what the pose leaves open, and the drift since the old
// landmarks went out of sight.
Eigen::Matrix3d Mapper::expected_jump(const Eigen::Matrix3d& prior) const {
  double unseen_m = 0.0;
  for (const Candidate& c : candidates_[0]) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    unseen_m = std::max(unseen_m, map_->way_m() - map_->info(c.slot).last_seen_way_m);
  }
  const double position = p_.loop_drift * unseen_m;
  const double heading = p_.loop_drift_deg_per_m * kDegree * unseen_m;
  Eigen::Matrix3d drift = prior + spread_in_body();
  drift.diagonal() += Eigen::Vector3d(position * position, position * position, heading * heading);
  return drift;
}

// Old landmarks are matched here alone: without evidence they constrain nothing.
bool Mapper::close_loop(const Features& features, const FeatureExtractor& view,
                        const Eigen::Matrix3d& prior) {
  const ClosingFrame frame = {
      candidates_[0].span(), features.span(),      *map_,       view, pose_.mean,
      correction_,           expected_jump(prior), travelled_m_};
  if (!closing_search_.update(frame, associator_, closing_)) return false;
  ++counters_.loops_closed;
  const Pose2 by_recent = frame.T_start_recent();
  const Eigen::Vector3d jump = vector_of(by_recent.inverse() * (closing_.T_old_recent * by_recent));
  const Eigen::Matrix3d C = closing_.correction.covariance + correction_.covariance;
  if (calibration_.enabled() && owns_map()) tie_to_old_map(frame, jump);
  const bool visible = jump.dot(C.ldlt().solve(jump)) > kVisible2 &&
                       (jump.head<2>().norm() > kVisible_m || std::abs(jump.z()) > kVisible_rad);
  if (!visible) {
    use_old_matches();
    const Eigen::Matrix3d K = correction_.covariance * C.inverse();
    correction_.xi += K * (closing_.correction.xi - correction_.xi);
    correction_.covariance -= K * correction_.covariance;
    return true;
  }
  return give_way(jump);
}

// Which piece of the map goes with which is known now, whatever the calibration: pose and recent
// map depend on it as the old map does, or the other way round. What the jump told of it is learned
// once, before they are tied.
void Mapper::tie_to_old_map(const ClosingFrame& frame, const Eigen::Vector3d& jump) {
  const double shorter_m = drift_travel_m_ - closing_.drift_travel_m;
  if (std::abs(shorter_m) < kClear_m) return;
  calibration_.begin_frame(kFree.cwiseAbs2().cwiseInverse().asDiagonal());
  const int best = heaviest_particle();
  for (const Candidate& c : closing_search_.matches()) {
    if (!c.inlier) continue;
    const Feature& f = frame.features[static_cast<std::size_t>(c.corner)];
    const Eigen::Vector2d z = seen_at(c, f).cast<double>();
    const ObservationModel model = linearise(map_->rows(c.slot), particles_.camera, best, lever_m(),
                                             static_cast<double>(c.noise));
    const SightSensitivity D =
        residual_sensitivity(model, z, map_->by_calibration(c.slot), pose_by_calibration_,
                             map_->anchor_by_calibration(c.slot), growth_);
    calibration_.add(c.anchor, z - c.m, c.G, D, c.own_trusted().inverse(), c.u);
  }
  PoseSensitivity tie = calibration_.pose_gain();
  if (!tie.allFinite()) return;
  calibration_.add_closing(jump, tie, frame.drift + closing_.correction.covariance);
  tie.topRows<2>() = rotation(pose_.mean.theta_rad) * tie.topRows<2>();
  if (shorter_m > 0.0) {
    map_->tie_piece(recent_piece(), tie, pose_.mean.position());
    pose_by_calibration_ += tie;
  } else {
    map_->tie_piece(old_piece(), -tie, pose_.mean.position());
  }
}

// A step of the calibration moves the pose, and the old landmarks in view otherwise: on average
// like this rigid body.
void Mapper::tell_closings(const CalibrationVector& step) {
  const Eigen::Vector2d at = pose_.mean.position();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Candidate& c : candidates_[0]) {
    if (!is_kind(c, CandidateKind::kPromotedOld)) continue;
    const Eigen::Vector3d move = -map_->anchor_by_calibration(c.slot) * step;
    const Eigen::Vector2d off = at - map_->anchor_m(c.slot);
    sum += Eigen::Vector3d(move.x() - move.z() * off.y(), move.y() + move.z() * off.x(), move.z());
    ++count;
  }
  if (count == 0) return;
  closing_search_.moved(moved_about(at, sum / count),
                        moved_about(at, -pose_by_calibration_ * step));
}

// The side whose drift travel is shorter stays. Where both are about equally long, parts of one map
// disagree, and nothing says which of them is right.
bool Mapper::give_way(const Eigen::Vector3d& jump) {
  const double shorter_m = drift_travel_m_ - closing_.drift_travel_m;
  if (owns_map() && std::abs(shorter_m) < kClear_m) return false;
  if (owns_map() && shorter_m < 0.0) {
    fetch_old_map();
    return true;
  }
  const double steps = std::max(jump.head<2>().norm() / kStep_m, std::abs(jump.z()) / kStep_rad);
  if (owns_map() && steps > 1.0) {
    const Pose2 by_recent = pose_.mean * pose_of(correction_.xi);
    glide_ = by_recent * pose_of(jump / steps) * by_recent.inverse();
    gliding_ = true;
    return true;
  }
  jumped_ = true;
  follow_old_map();
  use_old_matches();
  correction_ = closing_.in_frame;
  motion_.covariance += jump.cwiseAbs2().asDiagonal();
  return true;
}

// A corner serves one landmark: the old one, which is known better.
void Mapper::use_old_matches() {
  const auto candidates = candidates_[0].span();
  for (const Candidate& c : closing_search_.matches()) {
    if (!c.inlier) continue;
    for (Candidate& other : candidates) {
      if (other.slot == c.slot) {
        other.corner = c.corner;
        other.ncc = c.ncc;
        other.inlier = true;
      } else if (other.corner == c.corner) {
        other.corner = -1;
        other.inlier = false;
      }
    }
    corner_used_[static_cast<std::size_t>(c.corner)] = true;
  }
}

// The old map is right and what was mapped since is bent: recent landmarks do not constrain the
// pose in this frame. They will go with it.
void Mapper::follow_old_map() {
  for (Candidate& c : candidates_[0]) {
    if (is_kind(c, CandidateKind::kPromotedRecent) && c.corner >= 0) {
      corner_used_[static_cast<std::size_t>(c.corner)] = false;
      c.corner = -1;
      c.inlier = false;
    }
  }
  for (int i = 0; i < particles_.count; ++i) {
    before_[static_cast<std::size_t>(i)] = particles_.pose(i) * pose_of(correction_.xi);
  }
}

// Every particle at the place that the closing tells, to be drawn from there: by its own old map
// and within what the particles and the closing leave open.
void Mapper::jump_particles() {
  for (int i = 0; i < particles_.count; ++i) {
    particles_.set_pose(i, closing_.T_old_recent * before_[static_cast<std::size_t>(i)]);
  }
  motion_.covariance = spread_in_body() + closing_.correction.covariance;
  place_cameras(particles_, lever_m());
}

// A part of a jump: the robot and what was mapped recently, rigidly.
void Mapper::glide() {
  for (int i = 0; i < particles_.count; ++i) {
    particles_.set_pose(i, glide_ * particles_.pose(i));
    before_[static_cast<std::size_t>(i)] = glide_;
  }
  place_cameras(particles_, lever_m());
  map_->move_piece(recent_piece(), before_, glide_.theta_rad, 0.0);
  closing_search_.moved(glide_);
}

// What was mapped since the old landmarks went out of sight.
Map::Piece Mapper::recent_piece() const {
  const double between_m = 0.5 * (closing_.drift_travel_m + drift_travel_m_);
  return {0.0, p_.loop_travel_m, between_m, kEverything_m};
}

// What lies around the old landmarks in view.
Map::Piece Mapper::old_piece() const {
  const double w = closing_.drift_travel_m;
  return {p_.loop_travel_m, kEverything_m, std::max(w - kPiece_m, 0.5 * (w + drift_travel_m_)),
          w + kPiece_m};
}

// What was mapped since the old landmarks went out of sight moves with the robot, each particle's
// by its own jump: after it old and recent landmarks agree, so that it is not undone.
void Mapper::carry_recent_map() {
  for (int i = 0; i < particles_.count; ++i) {
    Pose2& T = before_[static_cast<std::size_t>(i)];
    T = particles_.pose(i) * T.inverse();
  }
  closing_search_.moved(closing_.T_old_recent);
  if (!owns_map()) return;
  const double shorter_m = std::max(drift_travel_m_ - closing_.drift_travel_m, 0.0);
  refresh_moved(
      map_->move_piece(recent_piece(), before_, closing_.T_old_recent.theta_rad, shorter_m));
  drift_travel_m_ -= shorter_m;
}

// The robot has drifted less than the old landmarks: they come to where it sees them.
void Mapper::fetch_old_map() {
  const Pose2 T = closing_.T_old_recent.inverse();
  std::fill(before_.begin(), before_.end(), T);
  refresh_moved(map_->move_piece(old_piece(), before_, T.theta_rad,
                                 closing_.drift_travel_m - drift_travel_m_));
  closing_search_.moved(closing_.T_old_recent);
}

void Mapper::refresh_moved(std::span<const std::int32_t> slots) {
  for (const std::int32_t slot : slots) {
    map_->info(slot).changed = true;
    refresh_place(slot);
  }
}

// The robot has drifted no further than the landmarks that it sees, but for the travel between
// them.
void Mapper::note_drift() {
  const auto used = std::count_if(candidates_[0].begin(), candidates_[0].end(),
                                  [](const Candidate& c) { return c.inlier && c.promoted; });
  if (used < kFewest) return;
  drift_travel_m_ =
      std::min(drift_travel_m_, median_drift(candidates_[0].span(), *map_) + kViewTravel_m);
}

}  // namespace zenith
