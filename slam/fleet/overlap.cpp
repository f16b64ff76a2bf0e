#include "slam/fleet/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/geometry.h"
#include "slam/kernels/match/match.h"

namespace zenith {
namespace {

static_assert(kMaxCorners <= kMaxQueries);

}  // namespace

void BestMatches::clear() {
  best_.clear();
  worst_ = 0;
  similar_ = 0;
}

void BestMatches::meet(const Similar& similar) {
  ++similar_;
  if (!best_.full()) {
    best_.push_back(similar);
  } else if (similar.ncc > best_[worst_].ncc) {
    best_[worst_] = similar;
  } else {
    return;
  }
  const auto* worst = std::min_element(best_.begin(), best_.end(),
                                       [](const auto& a, const auto& b) { return a.ncc < b.ncc; });
  worst_ = static_cast<std::size_t>(worst - best_.begin());
}

void BestMatches::append_to(int observed, OverlapMatches& out) const {
  for (const Similar& s : best_) {
    OverlapMatch match;
    match.observed = observed;
    match.peer_slot = s.slot;
    match.ncc = s.ncc;
    match.heading_rad = static_cast<float>(wrap_angle(s.turn_rad));
    match.weight = 1.0F / std::sqrt(static_cast<float>(similar_));
    out.push_back(match);
  }
}

bool heights_agree(const Observed& own, const PeerLandmark& peer, double tolerance_m) {
  // Three sigmas, compared in squares: this is asked of every pair of landmarks.
  const double beyond_m = std::abs(own.z_m - static_cast<double>(peer.z_m)) - tolerance_m;
  const double variance =
      own.z_sigma_m * own.z_sigma_m + static_cast<double>(peer.covariance_m2[5]);
  return beyond_m < 0.0 || beyond_m * beyond_m < 9.0 * variance;
}

void find_overlap(const ObservedFrame& frame, const PeerMap& peer, const OverlapSettings& settings,
                  OverlapMatches& out) {
  out.clear();
  const MatchKernels<kCompactLength>& match = match_in_use().compact;
  MatchQueries<kCompactLength> queries;
  std::array<BestMatches, kMaxCorners> best;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    match.pack(queries, frame[i].compact.values.data(), frame[i].compact.inverse_norm);
  }
  std::array<LookFound, kMaxCorners> found;
  for (int slot = 0; slot < peer.size(); ++slot) {
    const PeerLandmark& l = peer[slot];
    if (!l.present) continue;
    const std::span<const PeerAppearance> its = peer.looks(slot);
    if (its.empty()) continue;
    const CompactPatch& first = its.front().compact;
    const Looks looks = {first.values.data(), &first.inverse_norm, sizeof(PeerAppearance),
                         static_cast<int>(its.size())};
    // Looks first: few of them agree, and heights are asked of those alone.
    const int count = match.best_of(queries, looks, settings.ncc_min, found.data());
    for (int k = 0; k < count; ++k) {
      const LookFound& f = found[static_cast<std::size_t>(k)];
      const auto i = static_cast<std::size_t>(f.query);
      if (!heights_agree(frame[i], l, settings.height_tolerance_m)) continue;
      const float direction = its[static_cast<std::size_t>(f.look)].direction_rad;
      best[i].meet({slot, f.ncc, static_cast<double>(direction - frame[i].orientation_rad)});
    }
  }
  for (std::size_t i = 0; i < frame.size(); ++i) best[i].append_to(static_cast<int>(i), out);
  for (OverlapMatch& m : out) {
    m.from_robot_m = frame[static_cast<std::size_t>(m.observed)].from_robot_m;
    m.landmark_m = peer[m.peer_slot].xy();
  }
}

}  // namespace zenith
