#include "slam/fleet/overlap.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry.h"
#include "slam/image/ncc.h"

namespace zenith {

bool heights_agree(const Observed& own, const PeerLandmark& peer, double tolerance_m) {
  const double variance =
      own.z_sigma_m * own.z_sigma_m + static_cast<double>(peer.covariance_m2[5]);
  return std::abs(own.z_m - static_cast<double>(peer.z_m)) <
         tolerance_m + 3.0 * std::sqrt(variance);
}

LookMatch best_look(const PeerLandmark& landmark, const CompactPatch& patch) {
  LookMatch best;
  for (int i = 0; i < landmark.appearance_count; ++i) {
    const PeerAppearance& a = landmark.appearances[static_cast<std::size_t>(i)];
    const float similarity = ncc(a.compact, patch);
    if (similarity > best.ncc) best = {similarity, a.direction_rad};
  }
  return best;
}

void find_overlap(const ObservedFrame& frame, const PeerMap& peer, const OverlapSettings& settings,
                  OverlapMatches& out) {
  out.clear();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const Observed& own = frame[i];
    FixedVector<OverlapMatch, kMatchesPerObserved> best;
    int similar = 0;
    for (int slot = 0; slot < peer.size(); ++slot) {
      const PeerLandmark& l = peer[slot];
      if (!l.present || !heights_agree(own, l, settings.height_tolerance_m)) continue;
      const LookMatch look = best_look(l, own.compact);
      if (look.ncc < settings.ncc_min) continue;
      ++similar;
      const auto heading = static_cast<float>(
          wrap_angle(static_cast<double>(look.direction_rad - own.orientation_rad)));
      const OverlapMatch match = {static_cast<int>(i), slot, look.ncc, heading, 0.0F};
      if (best.push_back(match)) continue;
      auto* worst = std::min_element(best.begin(), best.end(),
                                     [](const auto& a, const auto& b) { return a.ncc < b.ncc; });
      if (worst->ncc < match.ncc) *worst = match;
    }
    for (OverlapMatch& match : best) {
      match.weight = 1.0F / std::sqrt(static_cast<float>(similar));
      out.push_back(match);
    }
  }
}

}  // namespace zenith
