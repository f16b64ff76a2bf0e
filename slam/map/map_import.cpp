#include "slam/map/map_import.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/filter/landmark_fusion.h"
#include "slam/map/same_landmark.h"

namespace zenith {
namespace {

// The looks of one landmark as further looks of another; those that it has already are left out.
void add_looks(Map& own, int own_slot, const Map& other, int slot, double turn_rad, float ncc_new) {
  std::array<std::int32_t, kMaxAppearances> looks = {};
  std::size_t count = 0;
  for (int i = other.info(slot).first_appearance; i >= 0; i = other.appearance(i).next) {
    looks[count++] = i;
  }
  while (count > 0) {  // the oldest first, as they came
    const Appearance& a = other.appearance(looks[--count]);
    const auto direction =
        static_cast<float>(wrap_angle(static_cast<double>(a.direction_rad) + turn_rad));
    if (own.best_ncc(own_slot, a.patch, direction, 4.0F) >= ncc_new) continue;
    own.add_appearance(own_slot, a.patch, a.compact, direction, a.centre_px());
  }
}

Eigen::Vector3d moved(const Pose2& T, const LandmarkInfo& l) {
  const Eigen::Vector3d p = l.position_m();
  const Eigen::Vector2d xy = T * p.head<2>();
  return {xy.x(), xy.y(), p.z()};
}

bool promoted(const LandmarkInfo& l) {
  return l.state == LandmarkState::kPromoted;
}

}  // namespace

void MapImport::layout(Arena& arena, int particles) {
  const auto stride = static_cast<std::size_t>(row_stride(particles));
  pairs_ = arena.take<SlotPair>(kMaxLandmarks);
  own_of_ = arena.take<std::int32_t>(kMaxLandmarks);
  other_of_ = arena.take<std::int32_t>(kMaxLandmarks);
  anchor_of_ = arena.take<std::int32_t>(kMaxAnchors);
  scratch_ = {arena.take<float>(stride).data(), arena.take<float>(stride).data(),
              arena.take<float>(stride).data(), arena.take<float>(stride).data()};
}

std::span<const SlotPair> MapImport::find_pairs(const Map& own, const Map& other,
                                                const Pose2& T_own_other,
                                                std::span<const SlotPair> known,
                                                const ImportSettings& settings) {
  std::fill(own_of_.begin(), own_of_.end(), -1);
  std::fill(other_of_.begin(), other_of_.end(), -1);
  const auto add = [this](int own_slot, int slot) {
    own_of_[static_cast<std::size_t>(slot)] = own_slot;
    other_of_[static_cast<std::size_t>(own_slot)] = slot;
  };
  for (const SlotPair& p : known) {
    const LandmarkInfo& a = own.info(p.own);
    const LandmarkInfo& b = other.info(p.other);
    if (!promoted(a) || !promoted(b)) continue;
    if (own_of_[static_cast<std::size_t>(p.other)] >= 0) continue;
    if (other_of_[static_cast<std::size_t>(p.own)] >= 0) continue;
    if ((a.position_m() - moved(T_own_other, b)).norm() < settings.pair_m) add(p.own, p.other);
  }
  const auto theirs = other.landmarks();
  for (std::size_t slot = 0; slot < theirs.size(); ++slot) {
    if (!promoted(theirs[slot]) || own_of_[slot] >= 0) continue;
    const int twin = find_twin(own, other, static_cast<int>(slot), T_own_other);
    if (twin >= 0) add(twin, static_cast<int>(slot));
  }
  std::size_t count = 0;
  for (std::size_t slot = 0; slot < theirs.size(); ++slot) {
    if (own_of_[slot] >= 0) pairs_[count++] = {own_of_[slot], static_cast<std::int32_t>(slot)};
  }
  return pairs_.first(count);
}

int MapImport::find_twin(const Map& own, const Map& other, int slot,
                         const Pose2& T_own_other) const {
  const LandmarkInfo& theirs = other.info(slot);
  const LookViews looks = looks_of(other, theirs);
  const Eigen::Matrix2d R = rotation(T_own_other.theta_rad);
  TwinSearch search(moved(T_own_other, theirs),
                    R * theirs.covariance().topLeftCorner<2, 2>() * R.transpose());
  const auto landmarks = own.landmarks();
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const LandmarkInfo& o = landmarks[k];
    if (!search.is_near(o.x_m, o.y_m, o.z_m) || !promoted(o) || other_of_[k] >= 0) continue;
    search.offer(static_cast<int>(k), o.position_m(), o.covariance().topLeftCorner<2, 2>(), [&] {
      return best_similarity(looks_of(own, o).span(), looks.span(), T_own_other.theta_rad);
    });
  }
  return search.twin();
}

ImportCounters MapImport::run(Map& own, Map& other, std::span<const Pose2> T_own_other,
                              const Pose2& T_mean, std::span<const SlotPair> pairs,
                              std::span<const double> weight, double camera_z_m,
                              const ImportSettings& settings) {
  ImportCounters counters;
  std::fill(own_of_.begin(), own_of_.end(), -1);
  std::fill(anchor_of_.begin(), anchor_of_.end(), -1);
  const double later_m = own.way_m() - other.way_m();
  for (const SlotPair& p : pairs) {
    fuse_landmark(own.rows(p.own), other.rows(p.other), T_own_other);
    LandmarkInfo& l = own.info(p.own);
    const LandmarkInfo& o = other.info(p.other);
    l.observations += o.observations;
    l.chances += o.chances;
    l.misses_in_row = std::min(l.misses_in_row, o.misses_in_row);
    l.last_seen_way_m = std::max(l.last_seen_way_m, o.last_seen_way_m + later_m);
    own_of_[static_cast<std::size_t>(p.other)] = p.own;
    ++counters.fused;
  }
  const auto theirs = other.landmarks();
  for (std::size_t slot = 0; slot < theirs.size(); ++slot) {
    if (theirs[slot].state == LandmarkState::kFree || own_of_[slot] >= 0) continue;
    if (take_over(own, other, static_cast<int>(slot), T_own_other, T_mean)) {
      own.info(own_of_[slot]).last_seen_way_m = theirs[slot].last_seen_way_m + later_m;
      ++counters.imported;
    } else {
      ++counters.rejected_full;
    }
  }
  for (std::size_t slot = 0; slot < theirs.size(); ++slot) {
    const int own_slot = own_of_[slot];
    if (own_slot < 0) continue;
    add_looks(own, own_slot, other, static_cast<int>(slot), T_mean.theta_rad,
              settings.ncc_new_appearance);
    own.info(own_slot).changed = true;
    if (!own.refresh_place(own_slot, weight.data(), camera_z_m)) own.remove(own_slot);
  }
  return counters;
}

bool MapImport::take_over(Map& own, Map& other, int slot, std::span<const Pose2> T_own_other,
                          const Pose2& T_mean) {
  const LandmarkInfo& from = other.info(slot);
  const LandmarkRows rows = other.rows(slot);
  std::int32_t& anchor = anchor_of_[static_cast<std::size_t>(from.anchor)];
  if (anchor < 0) {
    anchor = take_over_anchor(own, rows, T_own_other);
    if (anchor < 0) return false;
    own.anchor_drift(anchor) = other.anchor_drift(from.anchor).moved(T_mean);
  }
  const int to = own.create(anchor);
  if (to < 0) {
    own.release_if_unused(anchor);
    anchor = -1;
    return false;
  }
  own_of_[static_cast<std::size_t>(slot)] = to;
  const LandmarkRows r = own.rows(to);
  const float* source[kLandmarkRows] = {rows.ax,  rows.ay,  rows.rho, rows.pxx, rows.pxy,
                                        rows.pxr, rows.pyy, rows.pyr, rows.prr};
  float* target[kLandmarkRows] = {r.ax, r.ay, r.rho, r.pxx, r.pxy, r.pxr, r.pyy, r.pyr, r.prr};
  for (int k = 0; k < kLandmarkRows; ++k) std::copy_n(source[k], T_own_other.size(), target[k]);
  LandmarkInfo& l = own.info(to);
  l.state = from.state;
  l.observations = from.observations;
  l.chances = from.chances;
  l.misses_in_row = from.misses_in_row;
  return true;
}

int MapImport::take_over_anchor(Map& own, const LandmarkRows& rows,
                                std::span<const Pose2> T_own_other) {
  for (std::size_t i = 0; i < T_own_other.size(); ++i) {
    const Pose2& T = T_own_other[i];
    const Eigen::Vector2d at = T * Eigen::Vector2d(rows.anchor_x[i], rows.anchor_y[i]);
    const Eigen::Vector2d heading =
        rotation(T.theta_rad) * Eigen::Vector2d(rows.anchor_cos[i], rows.anchor_sin[i]);
    scratch_.x[i] = static_cast<float>(at.x());
    scratch_.y[i] = static_cast<float>(at.y());
    scratch_.cos[i] = static_cast<float>(heading.x());
    scratch_.sin[i] = static_cast<float>(heading.y());
  }
  return own.create_anchor(scratch_, PoseSensitivity::Zero());
}

}  // namespace zenith
