#include "slam/fleet/peer_map.h"

#include <algorithm>
#include <cmath>

namespace zenith {
namespace {

constexpr float kFarthest_m = 1e5F;

bool plausible(const LandmarkRecord& r) {
  const auto near = [](float x) { return std::isfinite(x) && std::abs(x) < kFarthest_m; };
  if (!near(r.x_m) || !near(r.y_m) || !near(r.z_m)) return false;
  for (const float c : r.covariance_m2) {
    if (!near(c)) return false;
  }
  const auto& c = r.covariance_m2;
  if (c[0] < 0.0F || c[3] < 0.0F || c[5] < 0.0F || c[0] * c[3] < c[1] * c[1]) return false;
  if (r.appearance_count > kPublishedAppearances) return false;
  for (int i = 0; i < r.appearance_count; ++i) {
    if (!near(r.appearances[static_cast<std::size_t>(i)].direction_rad)) return false;
  }
  return true;
}

}  // namespace

void PeerMap::layout(Arena& arena) {
  landmarks_ = arena.take<PeerLandmark>(kMaxPeerLandmarks);
  slot_of_ = arena.take<std::int32_t>(kBuckets);
}

std::size_t PeerMap::bucket(std::uint32_t id) const {
  std::size_t b = (id * 2654435761U) % kBuckets;  // Knuth's multiplicative hash
  while (slot_of_[b] != 0 && landmarks_[static_cast<std::size_t>(slot_of_[b] - 1)].id != id) {
    b = (b + 1) % kBuckets;
  }
  return b;
}

bool PeerMap::apply(const LandmarkRecord& r) {
  if (!plausible(r)) {
    ++rejected_;
    return false;
  }
  const std::size_t b = bucket(r.id);
  if (slot_of_[b] == 0) {
    if (count_ == landmarks_.size()) {
      ++rejected_;
      return false;
    }
    landmarks_[count_] = PeerLandmark{};
    landmarks_[count_].id = r.id;
    slot_of_[b] = static_cast<std::int32_t>(++count_);
  }
  PeerLandmark& l = landmarks_[static_cast<std::size_t>(slot_of_[b] - 1)];
  if (l.revision >= r.revision && l.revision != 0) return true;  // old news
  l.revision = r.revision;
  l.present = !r.removed;
  l.x_m = r.x_m;
  l.y_m = r.y_m;
  l.z_m = r.z_m;
  l.covariance_m2 = r.covariance_m2;
  l.observations = r.observations;
  l.appearance_count = r.appearance_count;
  for (std::size_t i = 0; i < r.appearance_count; ++i) {
    l.appearances[i] = {compact_from(r.appearances[i].descriptor), r.appearances[i].direction_rad};
  }
  return true;
}

}  // namespace zenith
