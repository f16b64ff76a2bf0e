#include "slam/fleet/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/geometry.h"
#include "slam/kernels/match/match.h"

namespace zenith {
namespace {

static_assert(kMaxCorners <= kMaxQueries);

// One observed landmark on its way through the peer's map.
class Seeker {
 public:
  void begin(const Observed& own) {
    own_ = &own;
    best_.clear();
    similar_ = 0;
  }

  // `appearance` of landmark `slot` is similar. This is asked often: only what is kept costs more.
  void meet(int slot, const PeerAppearance& appearance, float ncc) {
    ++similar_;
    const bool full = best_.full();
    if (full && ncc <= best_[worst_].ncc) return;
    const OverlapMatch match = {-1, slot, ncc, appearance.direction_rad, 0.0F};
    if (full) {
      best_[worst_] = match;
    } else {
      best_.push_back(match);
    }
    const auto* worst = std::min_element(
        best_.begin(), best_.end(), [](const auto& a, const auto& b) { return a.ncc < b.ncc; });
    worst_ = static_cast<std::size_t>(worst - best_.begin());
  }

  void tell(int observed, OverlapMatches& out) const {
    for (OverlapMatch match : best_) {
      match.observed = observed;
      match.heading_rad = static_cast<float>(
          wrap_angle(static_cast<double>(match.heading_rad - own_->orientation_rad)));
      match.weight = 1.0F / std::sqrt(static_cast<float>(similar_));
      out.push_back(match);
    }
  }

 private:
  const Observed* own_ = nullptr;
  FixedVector<OverlapMatch, kMatchesPerObserved> best_;
  std::size_t worst_ = 0;
  int similar_ = 0;
};

}  // namespace

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
  std::array<Seeker, kMaxCorners> seekers;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    match.pack(queries, frame[i].compact.values.data(), frame[i].compact.inverse_norm);
    seekers[i].begin(frame[i]);
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
      seekers[i].meet(slot, its[static_cast<std::size_t>(f.look)], f.ncc);
    }
  }
  for (std::size_t i = 0; i < frame.size(); ++i) seekers[i].tell(static_cast<int>(i), out);
}

}  // namespace zenith
