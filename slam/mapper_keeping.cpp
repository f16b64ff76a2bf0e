// The keeping of the map: what an observation leaves behind, promotion, pruning, new landmarks,
// eviction.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slam/mapper.h"

namespace zenith {
namespace {

constexpr double kNewLandmarkDistance_px = 5.0;
constexpr int kRefreshPerFrame = 8;
// A landmark's misfit is a running mean over so many matches, begun with so many of an honest one.
constexpr int kMisfitPrior = 10;
constexpr int kMisfitMemory = 50;
constexpr double kInView_m = 1.0;  // seen within this way: not to be evicted
constexpr int kEstablishedObservations = 10;
constexpr double kYoung_m = 3.0;  // of the way since it was begun, a map may be given up
// With fewer corners there is nothing to see, and no landmark to be started that would be seen
// again.
constexpr int kFewCorners = 4;
constexpr double kTentativeWay_m = 1.0;  // a tentative landmark unseen for this long is forgotten

}  // namespace

void Mapper::forget_unseen() {
  const auto landmarks = map_->landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    if (l.state != LandmarkState::kTentative) continue;
    if (map_->way_m() - l.last_seen_way_m <= kTentativeWay_m) continue;
    map_->remove(static_cast<int>(slot));
    ++counters_.landmarks_pruned;
  }
}

void Mapper::note(const Candidate& c, const Feature& f) {
  LandmarkInfo& l = map_->info(c.slot);
  if (l.state == LandmarkState::kFree || !refresh_place(c.slot)) return;
  ++l.observations;
  const int of = std::min(l.observations + kMisfitPrior, kMisfitMemory);
  l.misfit += (static_cast<float>(c.misfit) - l.misfit) / static_cast<float>(of);
  l.misses_in_row = 0;
  l.last_seen_way_m = map_->way_m();
  l.changed = true;
  const auto direction =
      static_cast<float>(wrap_angle(pose_.mean.theta_rad + static_cast<double>(f.orientation_rad)));
  const float best = map_->best_ncc(c.slot, f.patch, direction, 4.0F);
  if (best < static_cast<float>(p_.ncc_new_appearance) &&
      !map_->add_appearance(c.slot, f.patch, f.compact, direction, c.shift_px)) {
    ++counters_.appearances_rejected_full;
  }
}

// Places of landmarks out of sight move too, when the particles' weights, their ancestry or the
// calibration change: a few are read again in each frame, so that peers and readers hear of it.
void Mapper::refresh_in_turn() {
  const auto count = static_cast<int>(map_->landmarks().size());
  for (int k = 0; k < std::min(kRefreshPerFrame, count); ++k) {
    refresh_next_ = (refresh_next_ + 1) % count;
    LandmarkInfo& l = map_->info(refresh_next_);
    if (l.state != LandmarkState::kPromoted) continue;
    l.changed = refresh_place(refresh_next_);
  }
}

// A map whose scale is wrong never becomes right: while it is small, nothing is lost with it.
void Mapper::begin_anew() {
  const auto count = static_cast<int>(map_->landmarks().size());
  for (int slot = 0; slot < count; ++slot) {
    if (map_->info(slot).state == LandmarkState::kFree) continue;
    map_->remove(slot);
    ++counters_.landmarks_pruned;
  }
  corner_used_.fill(false);
  closing_search_.reset();
  first_ = true;
  ++counters_.begun_anew;
}

// Promotion and pruning.
void Mapper::keep() {
  const bool young = map_ == &own_map_ && travelled_m_ < kYoung_m;
  if (std::exchange(scale_wrong_, false) && young) begin_anew();
  check_map();
  refresh_in_turn();
  // A blind frame says nothing against landmarks that it does not show.
  if (blind_) return;
  for (const Candidate& c : candidates_[0]) {
    LandmarkInfo& l = map_->info(c.slot);
    if (l.state == LandmarkState::kFree) continue;
    if (c.well_inside || c.inlier) ++l.chances;
    if (!c.inlier && (c.well_inside || l.state == LandmarkState::kTentative)) ++l.misses_in_row;
    if (l.state == LandmarkState::kTentative) {
      const double z = static_cast<double>(l.z_m);
      const bool known =
          static_cast<double>(l.rho_sigma) < p_.promote_height_sigma * static_cast<double>(l.rho);
      const bool possible = z >= p_.min_height_m && z <= p_.max_height_m && l.rho > 0.0F;
      if (l.observations >= p_.promote_observations && known && possible) {
        l.state = LandmarkState::kPromoted;
        ++counters_.landmarks_promoted;
      } else if (l.misses_in_row >= 4 || (l.observations >= 40 && known && !possible)) {
        map_->remove(c.slot);
        ++counters_.landmarks_pruned;
      }
    } else if (l.observations < kEstablishedObservations && l.misses_in_row > 30) {
      map_->remove(c.slot);
      ++counters_.landmarks_pruned;
    }
  }
}

bool Mapper::near_candidate(const Feature& f) const {
  const double r = kNewLandmarkDistance_px * pixel_;
  for (const Candidate& c : candidates_[0]) {
    if (map_->info(c.slot).state == LandmarkState::kFree) continue;
    const Eigen::Vector2d d = Eigen::Vector2d(f.zx, f.zy) - c.m - c.G * correction_.xi;
    if (d.squaredNorm() < r * r) return true;
  }
  return false;
}

bool Mapper::shows_corners(const Features& features) {
  const auto described =
      std::count_if(features.begin(), features.end(), [](const Feature& f) { return f.described; });
  return described >= kFewCorners;
}

bool Mapper::start_due(const Features& features) const {
  if (blind_ && !shows_corners(features)) return false;
  const double turned = std::abs(wrap_angle(pose_.mean.theta_rad - anchor_heading_rad_));
  if (jumped_) return false;  // what is predicted is the map before the jump
  return first_ || travelled_m_ - anchor_travel_m_ >= p_.anchor_distance_m ||
         turned >= 5.0 * kDegree;
}

void Mapper::start_landmarks(const Features& features) {
  first_ = false;
  if (!undrawn_.covariance.isZero(0.0)) {
    draw_from_motion(particles_, std::exchange(undrawn_, {}).covariance, random_);
    check_poses();
    place_cameras(particles_, lever_m());
    estimate();
  }
  if (map_->anchors_used() == kMaxAnchors) evict_anchor();
  const int anchor = map_->create_anchor(particles_.camera, pose_by_calibration_, drift_travel_m_);
  if (anchor < 0) {
    ++counters_.landmarks_rejected_full;
    return;
  }
  map_->anchor_drift(anchor) = drift_.placed();
  anchor_travel_m_ = travelled_m_;
  anchor_heading_rad_ = pose_.mean.theta_rad;
  const auto rho_mean = static_cast<float>(depth_prior_.mean);
  const auto rho_sigma = static_cast<float>(depth_prior_.sigma);
  for (std::size_t k = 0; k < features.size(); ++k) {
    const Feature& f = features[k];
    if (corner_used_[k] || !f.described || near_candidate(f)) continue;
    if (map_->size() == kMaxLandmarks) evict_one();
    const int slot = map_->create(anchor);
    if (slot < 0) {
      ++counters_.landmarks_rejected_full;
      continue;
    }
    start_landmark(map_->rows(slot), particles_.count, f.zx, f.zy, f.noise, rho_mean, rho_sigma);
    map_->info(slot).start_rho_variance = rho_sigma * rho_sigma;
    map_->by_calibration(slot) = starting_sensitivity({f.zx, f.zy}, growth_);
    if (!refresh_place(slot)) continue;
    LandmarkInfo& l = map_->info(slot);
    l.observations = 1;
    l.chances = 1;
    l.last_seen_way_m = map_->way_m();
    const double direction =
        wrap_angle(pose_.mean.theta_rad + static_cast<double>(f.orientation_rad));
    if (!map_->add_appearance(slot, f.patch, f.compact, static_cast<float>(direction))) {
      ++counters_.appearances_rejected_full;
    }
    ++counters_.landmarks_created;
  }
  map_->release_if_unused(anchor);
}

// The anchor that holds the fewest landmarks gives way, with them. Never one with a landmark in
// view.
void Mapper::evict_anchor() {
  std::array<std::int16_t, kMaxAnchors> users = {};
  std::array<bool, kMaxAnchors> in_view = {};
  const auto landmarks = map_->landmarks();
  for (const LandmarkInfo& l : landmarks) {
    if (l.state == LandmarkState::kFree) continue;
    const auto a = static_cast<std::size_t>(l.anchor);
    ++users[a];
    in_view[a] |= l.last_seen_way_m > map_->way_m() - kInView_m;
  }
  int fewest = -1;
  for (int a = 0; a < kMaxAnchors; ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (users[i] == 0 || in_view[i]) continue;
    if (fewest < 0 || users[i] < users[static_cast<std::size_t>(fewest)]) fewest = a;
  }
  for (std::size_t slot = 0; slot < landmarks.size() && fewest >= 0; ++slot) {
    if (landmarks[slot].state == LandmarkState::kFree || landmarks[slot].anchor != fewest) continue;
    map_->remove(static_cast<int>(slot));
    ++counters_.landmarks_evicted;
  }
}

// The least useful landmark gives way: tentative before promoted, then the least observed, then the
// longest unseen. Never one in view.
void Mapper::evict_one() {
  int worst = -1;
  double worst_value = 0.0;
  const auto landmarks = map_->landmarks();
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const LandmarkInfo& l = landmarks[i];
    if (l.state == LandmarkState::kFree || l.last_seen_way_m > map_->way_m() - kInView_m) continue;
    const double value = (l.state == LandmarkState::kPromoted ? 1e6 : 0.0) +
                         100.0 * std::min(l.observations, 50) + l.last_seen_way_m * 1e-3;
    if (worst < 0 || value < worst_value) {
      worst = static_cast<int>(i);
      worst_value = value;
    }
  }
  if (worst < 0) return;
  map_->remove(worst);
  ++counters_.landmarks_evicted;
}

}  // namespace zenith
