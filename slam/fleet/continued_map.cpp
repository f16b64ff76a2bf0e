#include "slam/fleet/continued_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/fleet/fusion.h"
#include "slam/image/ncc.h"

namespace zenith {
namespace {

// As when maps are joined (map_import.h, duplicates.cpp): alike and near, or so near that a
// detector would not have kept two corners apart.
constexpr double kAlike_m = 0.15;
constexpr double kOneCorner_m = 0.05;
constexpr double kHeightsAlike_m = 0.3;
constexpr double kMaxTurn_rad = 0.5;
constexpr float kAlikeNcc = 0.6F;

using Used = std::array<bool, kMaxLandmarks>;

float similarity(const LandmarkRecord& a, const LandmarkRecord& b) {
  float best = 0.0F;
  for (std::size_t i = 0; i < a.appearance_count; ++i) {
    const CompactPatch look = compact_from(a.appearances[i].descriptor);
    for (std::size_t k = 0; k < b.appearance_count; ++k) {
      const AppearanceRecord& other = b.appearances[k];
      const double turn = static_cast<double>(a.appearances[i].direction_rad - other.direction_rad);
      if (std::abs(wrap_angle(turn)) > kMaxTurn_rad) continue;
      best = std::max(best, ncc(look, compact_from(other.descriptor)));
    }
  }
  return best;
}

// The past landmark that `own`, moved into the past frame, is; -1 when it is a new one.
int find_twin(std::span<const LandmarkRecord> past, const Used& used, const LandmarkRecord& own) {
  int twin = -1;
  double best = kAlike_m;
  for (std::size_t i = 0; i < past.size(); ++i) {
    const double dx = static_cast<double>(past[i].x_m - own.x_m);
    if (std::abs(dx) > best || used[i]) continue;
    const double distance = std::hypot(dx, static_cast<double>(past[i].y_m - own.y_m));
    const double dz = std::abs(static_cast<double>(past[i].z_m - own.z_m));
    if (distance > best || dz > kHeightsAlike_m) continue;
    if (distance > kOneCorner_m && similarity(past[i], own) < kAlikeNcc) continue;
    best = distance;
    twin = static_cast<int>(i);
  }
  return twin;
}

LandmarkEstimate moved(const LandmarkRecord& r, const Pose2& T, const Eigen::Matrix3d& covariance) {
  PeerLandmark l;
  l.id = r.id;
  l.x_m = r.x_m;
  l.y_m = r.y_m;
  l.z_m = r.z_m;
  l.covariance_m2 = r.covariance_m2;
  l.observations = r.observations;
  return transform_landmark(l, T, covariance);
}

void place(const LandmarkEstimate& e, LandmarkRecord& r) {
  r.x_m = static_cast<float>(e.position_m.x());
  r.y_m = static_cast<float>(e.position_m.y());
  r.z_m = static_cast<float>(e.position_m.z());
  const Eigen::Matrix3d& c = e.covariance_m2;
  const std::array<double, 6> upper = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  std::transform(upper.begin(), upper.end(), r.covariance_m2.begin(),
                 [](double v) { return static_cast<float>(v); });
  r.observations = static_cast<std::uint16_t>(std::min(e.observations, 65535));
}

// Past looks behind the present ones: light changes, and comes back.
void add_looks(const LandmarkRecord& past, LandmarkRecord& r) {
  constexpr std::size_t kPresent = 4;
  r.appearance_count = static_cast<std::uint8_t>(std::min<std::size_t>(
      r.appearance_count, past.appearance_count > 0 ? kPresent : kPublishedAppearances));
  for (std::size_t i = 0; i < past.appearance_count; ++i) {
    if (r.appearance_count == kPublishedAppearances) return;
    r.appearances[r.appearance_count++] = past.appearances[i];
  }
}

}  // namespace

std::size_t continue_map(std::span<const LandmarkRecord> past, std::span<const LandmarkRecord> own,
                         const Pose2& T_past_own, const Eigen::Matrix3d& T_covariance,
                         std::span<LandmarkRecord> out) {
  past = past.first(std::min(past.size(), std::size_t{kMaxLandmarks}));
  Used used = {};
  std::uint32_t last_id = 0;
  for (const LandmarkRecord& p : past) last_id = std::max(last_id, p.id);
  std::size_t count = 0;
  for (const LandmarkRecord& o : own) {
    if (count == out.size()) return count;
    LandmarkRecord& r = out[count++];
    r = o;
    const LandmarkEstimate now = moved(o, T_past_own, T_covariance);
    place(now, r);
    for (AppearanceRecord& look : r.appearances) {
      look.direction_rad = static_cast<float>(
          wrap_angle(static_cast<double>(look.direction_rad) + T_past_own.theta_rad));
    }
    const int twin = find_twin(past, used, r);
    if (twin < 0) {
      r.id = ++last_id;
      continue;
    }
    const LandmarkRecord& before = past[static_cast<std::size_t>(twin)];
    used[static_cast<std::size_t>(twin)] = true;
    place(fuse(moved(before, {}, Eigen::Matrix3d::Zero()),
               {before.id, now.position_m, now.covariance_m2, now.observations}),
          r);
    r.id = before.id;
    add_looks(before, r);
  }
  for (std::size_t i = 0; i < past.size() && count < out.size(); ++i) {
    if (!used[i]) out[count++] = past[i];
  }
  return count;
}

}  // namespace zenith
