#include "slam/fleet/publish.h"

#include <algorithm>

namespace zenith {
namespace {

constexpr float kMoved_m = 0.01F;
constexpr float kSharper = 0.5F;  // the covariance's trace fell to this share

bool worth_telling(const LandmarkInfo& l) {
  if (l.revision == 0) return true;
  const float dx = l.x_m - l.published_x_m;
  const float dy = l.y_m - l.published_y_m;
  const float dz = l.z_m - l.published_z_m;
  const float trace = l.covariance_m2[0] + l.covariance_m2[3] + l.covariance_m2[5];
  return dx * dx + dy * dy + dz * dz > kMoved_m * kMoved_m ||
         trace < kSharper * l.published_trace_m2 ||
         l.appearance_count >= l.published_appearances + 2;
}

LandmarkRecord make_record(const Map& map, const LandmarkInfo& l) {
  LandmarkRecord r;
  r.id = l.id;
  r.revision = l.revision;
  r.x_m = l.x_m;
  r.y_m = l.y_m;
  r.z_m = l.z_m;
  std::copy(std::begin(l.covariance_m2), std::end(l.covariance_m2), r.covariance_m2.begin());
  r.observations = static_cast<std::uint16_t>(std::min(l.observations, 65535));
  // The list begins with the newest look.
  for (int i = l.first_appearance; i >= 0 && r.appearance_count < kPublishedAppearances;
       i = map.appearance(i).next) {
    const Appearance& a = map.appearance(i);
    r.appearances[r.appearance_count++] = {a.compact.values, a.direction_rad};
  }
  return r;
}

}  // namespace

std::size_t publish_changes(Map& map, std::span<LandmarkRecord> out) {
  std::size_t count = 0;
  Map::Removal removal;
  while (count < out.size() && map.take_removal(removal)) {
    out[count] = LandmarkRecord{};
    out[count].id = removal.id;
    out[count].revision = removal.revision;
    out[count++].removed = true;
  }
  for (LandmarkInfo& l : map.landmarks()) {
    if (count == out.size()) break;
    if (l.state != LandmarkState::kPromoted || !l.changed) continue;
    if (!worth_telling(l)) {
      l.changed = false;
      continue;
    }
    l.changed = false;
    ++l.revision;
    l.published_x_m = l.x_m;
    l.published_y_m = l.y_m;
    l.published_z_m = l.z_m;
    l.published_trace_m2 = l.covariance_m2[0] + l.covariance_m2[3] + l.covariance_m2[5];
    l.published_appearances = l.appearance_count;
    out[count++] = make_record(map, l);
  }
  return count;
}

}  // namespace zenith
