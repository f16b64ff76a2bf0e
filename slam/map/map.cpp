#include "slam/map/map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "slam/bounds.h"
#include "slam/geometry.h"
#include "slam/image/ncc.h"

namespace zenith {
namespace {

constexpr auto kLandmarks = static_cast<std::size_t>(kMaxLandmarks);
constexpr auto kAnchors = static_cast<std::size_t>(kMaxAnchors);

// A row must be touched once in kGenerations resamplings; twice is the margin.
constexpr int kSweepLandmarks = 2 * kMaxLandmarks / static_cast<int>(Ancestry::kGenerations);
constexpr int kSweepAnchors = 2 * kMaxAnchors / static_cast<int>(Ancestry::kGenerations);
static_assert(kSweepLandmarks >= 1 && kSweepAnchors >= 1);

bool is_usable(const LandmarkPlace& place) {
  // A variance is a difference of sums, and may be a little less than nothing.
  constexpr double kRounding_m2 = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const double variance = place.covariance_m2(i, i);
    if (!is_within(place.mean_m[i], kFarthest_m)) return false;
    if (!(variance >= -kRounding_m2 && variance <= kMostVariance)) return false;
  }
  const Eigen::Matrix3d& c = place.covariance_m2;
  return std::isfinite(c(0, 1) + c(0, 2) + c(1, 2) + place.rho + place.rho_variance);
}

// An anchor's, by the first particle.
Eigen::Vector2d first_place(const AnchorRowStore& rows, int anchor) {
  return {static_cast<double>(rows.row(anchor, 0)[0]), static_cast<double>(rows.row(anchor, 1)[0])};
}

}  // namespace

void Map::layout(Arena& arena, int particles) {
  particles_ = particles;
  arena.part("own map: ancestry of particles");
  ancestry_.layout(arena, particles);
  arena.part("own map: landmarks' rows of particles");
  rows_.layout(arena, kMaxLandmarks, particles);
  arena.part("own map: anchors' rows of particles");
  anchor_rows_.layout(arena, kMaxAnchors, particles);
  arena.part("own map: landmarks, anchors, calibration");
  infos_ = arena.take<LandmarkInfo>(kLandmarks);
  free_slots_ = arena.take<std::int32_t>(kLandmarks);
  anchor_users_ = arena.take<std::int32_t>(kAnchors);
  anchor_drift_m_ = arena.take<float>(kAnchors);
  moved_ = arena.take<std::int32_t>(kLandmarks);
  free_anchors_ = arena.take<std::int32_t>(kAnchors);
  removals_ = arena.take<Removal>(kMaxRemovals);
  calibrations_ = arena.take<LandmarkCalibration>(kLandmarks);
  anchor_calibrations_ = arena.take<AnchorCalibration>(kAnchors);
  anchor_drifts_ = arena.take<PlacedDrift>(kAnchors);
  arena.part("own map: looks");
  pool_ = arena.take<Appearance>(kAppearancePool);
}

void Map::reset() {
  for (int i = 0; i < kMaxLandmarks; ++i) {
    infos_[static_cast<std::size_t>(i)] = LandmarkInfo{};
    free_slots_[static_cast<std::size_t>(i)] = kMaxLandmarks - 1 - i;
  }
  for (int i = 0; i < kMaxAnchors; ++i) {
    anchor_users_[static_cast<std::size_t>(i)] = 0;
    free_anchors_[static_cast<std::size_t>(i)] = kMaxAnchors - 1 - i;
  }
  for (int i = 0; i < kAppearancePool; ++i) {
    pool_[static_cast<std::size_t>(i)].next = i + 1 < kAppearancePool ? i + 1 : -1;
  }
  free_appearance_ = 0;
  appearances_free_ = kAppearancePool;
  size_ = 0;
  slots_used_ = 0;
  anchors_used_ = 0;
  removal_count_ = 0;
  kappa_ = 1.0F;
}

int Map::create(int anchor) {
  if (size_ == kMaxLandmarks) return -1;
  const int slot = free_slots_[static_cast<std::size_t>(kMaxLandmarks - 1 - size_)];
  ++size_;
  slots_used_ = std::max(slots_used_, slot + 1);
  LandmarkInfo& l = info(slot);
  assert(l.state == LandmarkState::kFree);
  l = LandmarkInfo{};
  l.state = LandmarkState::kTentative;
  l.id = next_id_++;
  l.anchor = anchor;
  l.kappa = kappa_;
  ++anchor_users_[static_cast<std::size_t>(anchor)];
  rows_.set_generation(slot, ancestry_.generation());
  calibrations_[static_cast<std::size_t>(slot)] = {LandmarkSensitivity::Zero(), calibration_};
  return slot;
}

void Map::remove(int slot) {
  LandmarkInfo& l = info(slot);
  assert(l.state != LandmarkState::kFree);
  if (l.state == LandmarkState::kFree) return;
  for (int i = l.first_appearance; i >= 0;) {
    const int next = pool_[static_cast<std::size_t>(i)].next;
    pool_[static_cast<std::size_t>(i)].next = free_appearance_;
    free_appearance_ = i;
    ++appearances_free_;
    i = next;
  }
  if (l.revision > 0) {
    if (removal_count_ == removals_.size()) {
      ++removals_untold_;
    } else {
      removals_[(removal_first_ + removal_count_++) % removals_.size()] = {l.id, l.revision + 1};
    }
  }
  const int anchor = l.anchor;
  l = LandmarkInfo{};
  --size_;
  free_slots_[static_cast<std::size_t>(kMaxLandmarks - 1 - size_)] = slot;
  --anchor_users_[static_cast<std::size_t>(anchor)];
  release_if_unused(anchor);
}

bool Map::take_removal(Removal& out) {
  if (removal_count_ == 0) return false;
  out = removals_[removal_first_];
  removal_first_ = (removal_first_ + 1) % removals_.size();
  --removal_count_;
  return true;
}

int Map::create_anchor(const CameraRows& camera, const PoseSensitivity& by_calibration,
                       double drift_travel_m) {
  if (anchors_used_ == kMaxAnchors) return -1;
  const int anchor = free_anchors_[static_cast<std::size_t>(kMaxAnchors - 1 - anchors_used_)];
  ++anchors_used_;
  std::copy_n(camera.x, particles_, anchor_rows_.row(anchor, 0));
  std::copy_n(camera.y, particles_, anchor_rows_.row(anchor, 1));
  std::copy_n(camera.cos, particles_, anchor_rows_.row(anchor, 2));
  std::copy_n(camera.sin, particles_, anchor_rows_.row(anchor, 3));
  anchor_rows_.set_generation(anchor, ancestry_.generation());
  anchor_calibrations_[static_cast<std::size_t>(anchor)] = {by_calibration, calibration_};
  anchor_drifts_[static_cast<std::size_t>(anchor)] = {};
  anchor_drift_m_[static_cast<std::size_t>(anchor)] = static_cast<float>(drift_travel_m);
  return anchor;
}

Map::AnchorFlags Map::anchors_of(const Piece& piece) const {
  AnchorFlags flags = {};
  for (const LandmarkInfo& l : landmarks()) {
    if (l.state == LandmarkState::kFree) continue;
    const auto a = static_cast<std::size_t>(l.anchor);
    const double unseen_m = way_m_ - l.last_seen_way_m;
    const auto drift_m = static_cast<double>(anchor_drift_m_[a]);
    if (unseen_m < piece.unseen_from_m || unseen_m > piece.unseen_to_m) continue;
    flags[a] = drift_m > piece.drift_from_m && drift_m < piece.drift_to_m;
  }
  return flags;
}

std::span<const std::int32_t> Map::move_piece(const Piece& piece, std::span<const Pose2> T_new_old,
                                              double turn_rad, double shorter_m) {
  const AnchorFlags moves = anchors_of(piece);
  for (int anchor = 0; anchor < kMaxAnchors; ++anchor) {
    const auto a = static_cast<std::size_t>(anchor);
    if (!moves[a]) continue;
    anchor_drift_m_[a] = std::max(anchor_drift_m_[a] - static_cast<float>(shorter_m), 0.0F);
    move_anchor(anchor, T_new_old);
  }
  std::size_t count = 0;
  for (int slot = 0; slot < slots_used_; ++slot) {
    const LandmarkInfo& l = info(slot);
    if (l.state == LandmarkState::kFree || !moves[static_cast<std::size_t>(l.anchor)]) continue;
    for (int i = l.first_appearance; i >= 0;) {
      Appearance& a = pool_[static_cast<std::size_t>(i)];
      a.direction_rad =
          static_cast<float>(wrap_angle(static_cast<double>(a.direction_rad) + turn_rad));
      i = a.next;
    }
    moved_[count++] = slot;
  }
  return moved_.first(count);
}

Eigen::Vector2d Map::anchor_m(int slot) const {
  return first_place(anchor_rows_, info(slot).anchor);
}

void Map::tie_piece(const Piece& piece, const PoseSensitivity& by_calibration,
                    const Eigen::Vector2d& at_m) {
  const AnchorFlags tied = anchors_of(piece);
  for (int anchor = 0; anchor < kMaxAnchors; ++anchor) {
    const auto i = static_cast<std::size_t>(anchor);
    if (!tied[i]) continue;
    anchor_rows_.bring(anchor, ancestry_);
    follow_calibration(anchor);
    const Eigen::Vector2d off = first_place(anchor_rows_, anchor) - at_m;
    PoseSensitivity& A = anchor_calibrations_[i].A;
    A += by_calibration;
    A.row(0) -= off.y() * by_calibration.row(2);
    A.row(1) += off.x() * by_calibration.row(2);
  }
}

void Map::move_anchor(int anchor, std::span<const Pose2> T_new_old) {
  anchor_rows_.bring(anchor, ancestry_);
  float* x = anchor_rows_.row(anchor, 0);
  float* y = anchor_rows_.row(anchor, 1);
  float* cos = anchor_rows_.row(anchor, 2);
  float* sin = anchor_rows_.row(anchor, 3);
  for (std::size_t i = 0; i < T_new_old.size(); ++i) {
    const Pose2& T = T_new_old[i];
    const Eigen::Vector2d at =
        T * Eigen::Vector2d(static_cast<double>(x[i]), static_cast<double>(y[i]));
    const Eigen::Vector2d ahead =
        rotation(T.theta_rad) *
        Eigen::Vector2d(static_cast<double>(cos[i]), static_cast<double>(sin[i]));
    x[i] = static_cast<float>(at.x());
    y[i] = static_cast<float>(at.y());
    cos[i] = static_cast<float>(ahead.x());
    sin[i] = static_cast<float>(ahead.y());
  }
}

void Map::release_if_unused(int anchor) {
  if (anchor_users_[static_cast<std::size_t>(anchor)] > 0) return;
  --anchors_used_;
  free_anchors_[static_cast<std::size_t>(kMaxAnchors - 1 - anchors_used_)] = anchor;
}

bool Map::add_appearance(int slot, const Patch& patch, const CompactPatch& compact,
                         float direction_rad, const Eigen::Vector2f& centre_px) {
  LandmarkInfo& l = info(slot);
  const int kept = l.appearance_count == 0 ? 0 : kMaxLandmarks - size_;
  if (l.appearance_count == kMaxAppearances || appearances_free_ <= kept) return false;
  const int i = free_appearance_;
  Appearance& a = pool_[static_cast<std::size_t>(i)];
  free_appearance_ = a.next;
  --appearances_free_;
  const auto step = [](float px) {
    return static_cast<std::int8_t>(
        std::clamp(std::round(px / Appearance::kCentreStep_px), -127.0F, 127.0F));
  };
  a = {patch,
       compact,
       {step(centre_px.x()), step(centre_px.y())},
       direction_rad,
       l.first_appearance};
  l.first_appearance = i;
  ++l.appearance_count;
  return true;
}

LandmarkRows Map::rows(int slot) {
  // A free slot has no anchor: the first one's rows are at least rows of this map.
  assert(info(slot).state != LandmarkState::kFree);
  const int anchor = std::max(info(slot).anchor, 0);
  rows_.bring(slot, ancestry_);
  anchor_rows_.bring(anchor, ancestry_);
  follow_calibration(slot, anchor);
  follow_noise(slot);
  return landmark_rows(rows_, slot, anchor_rows_, anchor);
}

void Map::follow_calibration(int slot, int anchor) {
  LandmarkCalibration& l = calibrations_[static_cast<std::size_t>(slot)];
  const Eigen::Vector3f move = (l.B * (l.beta - calibration_)).cast<float>();
  l.beta = calibration_;
  for (int r = 0; r < 3; ++r) {
    if (move[r] == 0.0F) continue;
    float* row = rows_.row(slot, r);
    for (int i = 0; i < particles_; ++i) row[i] += move[r];
  }
  follow_calibration(anchor);
}

void Map::follow_calibration(int anchor) {
  AnchorCalibration& a = anchor_calibrations_[static_cast<std::size_t>(anchor)];
  const Eigen::Vector3f shift = (a.A * (a.beta - calibration_)).cast<float>();
  a.beta = calibration_;
  if (shift.isZero(0.0F)) return;
  float* x = anchor_rows_.row(anchor, 0);
  float* y = anchor_rows_.row(anchor, 1);
  float* c = anchor_rows_.row(anchor, 2);
  float* s = anchor_rows_.row(anchor, 3);
  const float dc = std::cos(shift[2]);
  const float ds = std::sin(shift[2]);
  for (int i = 0; i < particles_; ++i) {
    x[i] += shift[0];
    y[i] += shift[1];
    const float ci = c[i];
    c[i] = ci * dc - s[i] * ds;
    s[i] = s[i] * dc + ci * ds;
  }
}

// Given its anchor's pose, a landmark's covariance is that of the corners it was made of, but for
// what was known of the inverse height before: P grows with the noise, P_rr not above its start.
void Map::follow_noise(int slot) {
  constexpr float kMuch = 1.02F;
  LandmarkInfo& l = info(slot);
  if (kappa_ <= kMuch * l.kappa) return;
  const float grow = kappa_ / l.kappa;
  l.kappa = kappa_;
  float* pxx = rows_.row(slot, 3);
  float* pxy = rows_.row(slot, 4);
  float* pxr = rows_.row(slot, 5);
  float* pyy = rows_.row(slot, 6);
  float* pyr = rows_.row(slot, 7);
  float* prr = rows_.row(slot, 8);
  for (int i = 0; i < particles_; ++i) {
    const float grow_r = std::max(std::min(grow, l.start_rho_variance / prr[i]), 1.0F);
    const float both = std::sqrt(grow * grow_r);
    pxx[i] *= grow;
    pxy[i] *= grow;
    pyy[i] *= grow;
    pxr[i] *= both;
    pyr[i] *= both;
    prr[i] *= grow_r;
  }
}

bool Map::refresh_place(int slot, const double* weight, double camera_z_m) {
  const LandmarkPlace place = place_landmark(rows(slot), weight, particles_, camera_z_m);
  if (!is_usable(place)) return false;
  LandmarkInfo& l = info(slot);
  l.x_m = static_cast<float>(place.mean_m.x());
  l.y_m = static_cast<float>(place.mean_m.y());
  l.z_m = static_cast<float>(place.mean_m.z());
  const Eigen::Matrix3d& c = place.covariance_m2;
  const double six[6] = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  for (int i = 0; i < 6; ++i) l.covariance_m2[i] = static_cast<float>(six[i]);
  l.rho = static_cast<float>(place.rho);
  l.rho_sigma = static_cast<float>(std::sqrt(std::max(place.rho_variance, 0.0)));
  return true;
}

void Map::resampled(std::span<const std::uint16_t> parents) {
  ancestry_.push(parents);
  for (int k = 0; k < kSweepLandmarks; ++k) {
    if (info(sweep_landmark_).state != LandmarkState::kFree)
      rows_.bring(sweep_landmark_, ancestry_);
    sweep_landmark_ = (sweep_landmark_ + 1) % kMaxLandmarks;
  }
  for (int k = 0; k < kSweepAnchors; ++k) {
    if (anchor_users_[static_cast<std::size_t>(sweep_anchor_)] > 0) {
      anchor_rows_.bring(sweep_anchor_, ancestry_);
    }
    sweep_anchor_ = (sweep_anchor_ + 1) % kMaxAnchors;
  }
}

Map::Look Map::best_look(int slot, const Patch& patch, float direction_rad,
                         float max_turn_rad) const {
  Look best;
  for (int i = info(slot).first_appearance; i >= 0; i = appearance(i).next) {
    const Appearance& a = appearance(i);
    const double turn = wrap_angle(static_cast<double>(a.direction_rad - direction_rad));
    if (std::abs(turn) > static_cast<double>(max_turn_rad)) continue;
    const float similarity = ncc(a.patch, patch);
    if (similarity > best.ncc) best = {&a, similarity};
  }
  return best;
}

}  // namespace zenith
