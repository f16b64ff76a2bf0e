#include "slam/map/same_landmark.h"

#include "slam/geometry.h"
#include "slam/image/ncc.h"

namespace zenith {

LookViews looks_of(const Map& map, const LandmarkInfo& landmark) {
  LookViews looks;
  for (int i = landmark.first_appearance; i >= 0; i = map.appearance(i).next) {
    looks.push_back({&map.appearance(i).compact, map.appearance(i).direction_rad});
  }
  return looks;
}

float best_similarity(std::span<const LookView> a, std::span<const LookView> b, double turn_rad) {
  float best = 0.0F;
  for (const LookView& x : a) {
    for (const LookView& y : b) {
      const double turn = static_cast<double>(x.direction_rad - y.direction_rad);
      if (std::abs(wrap_angle(turn - turn_rad)) > kSameTurn_rad) continue;
      best = std::max(best, ncc(*x.patch, *y.patch));
    }
  }
  return best;
}

}  // namespace zenith
