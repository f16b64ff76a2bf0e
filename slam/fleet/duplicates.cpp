#include "slam/fleet/duplicates.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "slam/image/ncc.h"

namespace zenith {
namespace {

constexpr int kSweepPerFrame = 96;
// A stored map is large from the start while the own one is small: more of it for the same work.
constexpr int kPairsPerFrame = kSweepPerFrame * kMaxLandmarks;

int sweep_per_frame(const Peer& peer, const Map& map) {
  if (!peer.past) return kSweepPerFrame;
  const int own = std::max(static_cast<int>(map.landmarks().size()), 1);
  return std::max(kPairsPerFrame / own, kSweepPerFrame);
}

constexpr float kDuplicateNcc = 0.6F;
constexpr double kDuplicateSigmas = 3.0;
// Errors of the maps that the landmarks' covariances do not tell: their drift in common.
constexpr double kMapError_m = 0.025;
// Of corners that are told apart by their looks alone, two within kOneCorner_m of each other are
// one once the maps are merged: a detector keeps corners further apart than that.
constexpr double kOneCorner_m = 0.05;
constexpr float kHeightsAlike_m = 0.3F;
constexpr double kMaxTurn_rad = 0.5;

// Whether two landmarks `d` apart lie within the uncertainty of both (P: the peer's, transformed).
bool may_be_one(const Eigen::Matrix2d& P, const LandmarkInfo& own, const Eigen::Vector2d& d) {
  const Eigen::Matrix2d S = P + own.covariance().topLeftCorner<2, 2>() +
                            kMapError_m * kMapError_m * Eigen::Matrix2d::Identity();
  return d.dot(S.inverse() * d) < kDuplicateSigmas * kDuplicateSigmas;
}

bool has_partner(const Hypothesis& h, int own_slot, int peer_slot) {
  for (const LandmarkPair& p : h.pairs) {
    if (p.own_slot == own_slot || p.peer_slot == peer_slot) return true;
  }
  return false;
}

// The best NCC of any two looks that point the same way once the peer's are turned by `turn_rad`.
float best_similarity(const Map& map, const LandmarkInfo& own,
                      std::span<const PeerAppearance> theirs, double turn_rad) {
  float best = 0.0F;
  for (int i = own.first_appearance; i >= 0; i = map.appearance(i).next) {
    const Appearance& a = map.appearance(i);
    for (const PeerAppearance& b : theirs) {
      const double turn = static_cast<double>(a.direction_rad - b.direction_rad);
      if (std::abs(wrap_angle(turn - turn_rad)) > kMaxTurn_rad) continue;
      best = std::max(best, ncc(a.compact, b.compact));
    }
  }
  return best;
}

// What the own map has where one of the peer's landmarks is said to be.
struct Near {
  bool any = false;     // any landmark of that height
  int similar = -1;     // slot of the most similar one
  int one_corner = -1;  // slot of the nearest within kOneCorner_m, whatever it looks like
};

Near look_around(const Hypothesis& h, const PeerMap& peer, int peer_slot, const Map& map) {
  Near near;
  const PeerLandmark& l = peer[peer_slot];
  const Eigen::Vector2d at = h.T_own_peer * l.xy();
  const Eigen::Matrix2d P =
      transform_covariance(h.T_own_peer, h.covariance, l.xy(), l.covariance_xy());
  const double reach = std::min(kDuplicateSigmas * std::sqrt(P.trace()) + 0.08, 0.4);
  const auto own = map.landmarks();
  double nearest = kOneCorner_m * kOneCorner_m;
  float best = kDuplicateNcc;
  for (std::size_t slot = 0; slot < own.size(); ++slot) {
    const LandmarkInfo& o = own[slot];
    const double dx = static_cast<double>(o.x_m) - at.x();
    const double dy = static_cast<double>(o.y_m) - at.y();
    const double flat = dx * dx + dy * dy;
    if (flat > 4.0 * reach * reach || o.state != LandmarkState::kPromoted) continue;
    if (std::abs(o.z_m - l.z_m) > kHeightsAlike_m) continue;
    const double dz = static_cast<double>(o.z_m - l.z_m);
    near.any = true;
    if (flat + dz * dz < nearest) {
      nearest = flat + dz * dz;
      near.one_corner = static_cast<int>(slot);
    }
    if (flat > reach * reach || !may_be_one(P, o, {dx, dy})) continue;
    const float similarity = best_similarity(map, o, peer.looks(peer_slot), h.T_own_peer.theta_rad);
    if (similarity <= best) continue;
    best = similarity;
    near.similar = static_cast<int>(slot);
  }
  return near;
}

}  // namespace

void search_duplicates(Peer& peer, int place, const Map& map) {
  Hypothesis& h = peer.hypothesis(place);
  const int count = sweep_per_frame(peer, map);
  for (int n = 0; n < count; ++n) {
    const int slot = peer.sweep;
    peer.sweep = (peer.sweep + 1) % peer.map.size();
    const PeerLandmark& l = peer.map[slot];
    if (l.present) {
      const Near near = look_around(h, peer.map, slot, map);
      peer.swept.expected += near.any ? 1 : 0;
      peer.swept.hits += near.similar >= 0 ? 1 : 0;
      int partner = near.similar;
      if (partner < 0 && peer.merged && near.one_corner >= 0 &&
          !has_partner(h, near.one_corner, slot)) {
        partner = near.one_corner;
      }
      if (partner >= 0) confirm_pair(h, {partner, map.info(partner).id, slot, l.id, 1});
    }
    if (peer.sweep == 0) break;  // a walk is over
  }
}

}  // namespace zenith
