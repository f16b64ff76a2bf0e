#include "slam/fleet/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/geometry.h"

namespace zenith {
namespace {

// Twice as wide, so that products add up in 32 bits two at a time on every instruction set.
using WidePatch = std::array<std::int16_t, kCompactLength>;

WidePatch widen(const CompactPatch& patch) {
  WidePatch wide;
  std::copy(patch.values.begin(), patch.values.end(), wide.begin());
  return wide;
}

int dot(const WidePatch& a, const WidePatch& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += int{a[i]} * int{b[i]};
  return sum;
}

// All looks of one landmark.
struct WideLooks {
  explicit WideLooks(const PeerLandmark& l) {
    for (int i = 0; i < l.appearance_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      patches[k] = widen(l.appearances[k].compact);
    }
  }
  std::array<WidePatch, kPublishedAppearances> patches;
};

// One observed landmark on its way through the peer's map.
class Seeker {
 public:
  void begin(const Observed& own, const OverlapSettings& settings) {
    own_ = &own;
    wide_ = widen(own.compact);
    tolerance_m_ = settings.height_tolerance_m;
    best_.clear();
    similar_ = 0;
  }

  bool may_be_at(const PeerLandmark& l) const { return heights_agree(*own_, l, tolerance_m_); }

  void meet(int slot, const PeerLandmark& l, const WideLooks& looks, float ncc_min) {
    float ncc = -1.0F;
    float direction_rad = 0.0F;
    for (int i = 0; i < l.appearance_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const float similarity = static_cast<float>(dot(looks.patches[k], wide_)) *
                               l.appearances[k].compact.inverse_norm * own_->compact.inverse_norm;
      if (similarity <= ncc) continue;
      ncc = similarity;
      direction_rad = l.appearances[k].direction_rad;
    }
    if (ncc < ncc_min) return;
    ++similar_;
    const auto heading =
        static_cast<float>(wrap_angle(static_cast<double>(direction_rad - own_->orientation_rad)));
    const OverlapMatch match = {-1, slot, ncc, heading, 0.0F};
    if (best_.push_back(match)) return;
    auto* worst = std::min_element(best_.begin(), best_.end(),
                                   [](const auto& a, const auto& b) { return a.ncc < b.ncc; });
    if (worst->ncc < match.ncc) *worst = match;
  }

  void tell(int observed, OverlapMatches& out) const {
    for (OverlapMatch match : best_) {
      match.observed = observed;
      match.weight = 1.0F / std::sqrt(static_cast<float>(similar_));
      out.push_back(match);
    }
  }

 private:
  const Observed* own_ = nullptr;
  WidePatch wide_;
  double tolerance_m_ = 0.0;
  FixedVector<OverlapMatch, kMatchesPerObserved> best_;
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
  std::array<Seeker, kMaxCorners> seekers;
  for (std::size_t i = 0; i < frame.size(); ++i) seekers[i].begin(frame[i], settings);
  for (int slot = 0; slot < peer.size(); ++slot) {
    const PeerLandmark& l = peer[slot];
    if (!l.present) continue;
    const WideLooks looks(l);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (seekers[i].may_be_at(l)) seekers[i].meet(slot, l, looks, settings.ncc_min);
    }
  }
  for (std::size_t i = 0; i < frame.size(); ++i) seekers[i].tell(static_cast<int>(i), out);
}

}  // namespace zenith
