#include "slam/fleet/continued_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slam/fleet/fusion.h"
#include "slam/map/same_landmark.h"

namespace zenith {
namespace {

Eigen::Matrix2d flat_covariance(const LandmarkRecord& r) {
  const auto& c = r.covariance_m2;
  return (Eigen::Matrix2d() << c[0], c[1], c[1], c[3]).finished();
}

// The past landmarks that have no twin yet, in rising x: few need to be looked at for each own one.
class ByPlace {
 public:
  explicit ByPlace(std::span<const LandmarkRecord> past) : past_(past) {
    for (std::size_t i = 0; i < past.size(); ++i) {
      order_[i] = {past[i].x_m, static_cast<std::int32_t>(i)};
    }
    std::sort(order_.begin(), end());
  }

  int find_twin(const LandmarkRecord& own);
  void take(int i) { taken_[static_cast<std::size_t>(i)] = true; }
  bool is_taken(std::size_t i) const { return taken_[i]; }

 private:
  using Entry = std::pair<float, std::int32_t>;
  std::array<Entry, kMaxLandmarks>::iterator end() {
    return order_.begin() + static_cast<std::ptrdiff_t>(past_.size());
  }

  std::span<const LandmarkRecord> past_;
  std::array<Entry, kMaxLandmarks> order_;
  std::array<bool, kMaxLandmarks> taken_ = {};
};

// A record's looks, unpacked.
struct Looks {
  explicit Looks(const LandmarkRecord& r) {
    for (std::size_t i = 0; i < r.appearance_count; ++i) {
      patches[i] = compact_from(r.appearances[i].descriptor);
      views.push_back({&patches[i], r.appearances[i].direction_rad});
    }
  }
  Looks(const Looks&) = delete;
  Looks& operator=(const Looks&) = delete;

  std::array<CompactPatch, kPublishedAppearances> patches;
  LookViews views;
};

// The past landmark that `own`, moved into the past frame, is; -1 when it is a new one.
int ByPlace::find_twin(const LandmarkRecord& own) {
  constexpr float kFarthest_m = 2.0F * static_cast<float>(kSameReach_m);
  TwinSearch search({own.x_m, own.y_m, own.z_m}, flat_covariance(own));
  const Looks looks(own);
  auto entry = std::lower_bound(order_.begin(), end(), Entry{own.x_m - kFarthest_m, 0});
  for (; entry != end() && entry->first <= own.x_m + kFarthest_m; ++entry) {
    const LandmarkRecord& p = past_[static_cast<std::size_t>(entry->second)];
    if (!search.is_near(p.x_m, p.y_m, p.z_m) || is_taken(static_cast<std::size_t>(entry->second))) {
      continue;
    }
    search.offer(entry->second, {p.x_m, p.y_m, p.z_m}, flat_covariance(p),
                 [&] { return best_similarity(looks.views.span(), Looks(p).views.span(), 0.0); });
  }
  return search.twin();
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
  ByPlace by_place(past);
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
    const int twin = by_place.find_twin(r);
    if (twin < 0) {
      r.id = ++last_id;
      continue;
    }
    const LandmarkRecord& before = past[static_cast<std::size_t>(twin)];
    by_place.take(twin);
    place(fuse(moved(before, {}, Eigen::Matrix3d::Zero()),
               {before.id, now.position_m, now.covariance_m2, now.observations}),
          r);
    r.id = before.id;
    add_looks(before, r);
  }
  for (std::size_t i = 0; i < past.size() && count < out.size(); ++i) {
    if (!by_place.is_taken(i)) out[count++] = past[i];
  }
  return count;
}

}  // namespace zenith
