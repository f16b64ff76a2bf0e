#include "slam/fleet/duplicates.h"

#include <algorithm>

#include "slam/map/same_landmark.h"

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

bool has_partner(const Hypothesis& h, int own_slot, int peer_slot) {
  for (const LandmarkPair& p : h.pairs) {
    if (p.own_slot == own_slot || p.peer_slot == peer_slot) return true;
  }
  return false;
}

// What the own map has where one of the peer's landmarks is said to be.
TwinSearch look_around(const Hypothesis& h, const PeerMap& peer, int peer_slot, const Map& map) {
  const PeerLandmark& l = peer[peer_slot];
  const Eigen::Vector2d at = h.T_own_peer * l.xy();
  LookViews theirs;
  for (const PeerAppearance& look : peer.looks(peer_slot)) {
    theirs.push_back({&look.compact, look.direction_rad});
  }
  TwinSearch search({at.x(), at.y(), static_cast<double>(l.z_m)},
                    transform_covariance(h.T_own_peer, h.covariance, l.xy(), l.covariance_xy()));
  const auto own = map.landmarks();
  for (std::size_t slot = 0; slot < own.size(); ++slot) {
    const LandmarkInfo& o = own[slot];
    if (!search.is_near(o.x_m, o.y_m, o.z_m) || o.state != LandmarkState::kPromoted) continue;
    search.offer(static_cast<int>(slot), o.position_m(), o.covariance().topLeftCorner<2, 2>(), [&] {
      return best_similarity(looks_of(map, o).span(), theirs.span(), h.T_own_peer.theta_rad);
    });
  }
  return search;
}

}  // namespace

void search_duplicates(Peer& peer, int place, const Map& map) {
  if (peer.map.empty()) return;
  Hypothesis& h = peer.hypothesis(place);
  const int count = sweep_per_frame(peer, map);
  for (int n = 0; n < count; ++n) {
    const int slot = peer.sweep;
    peer.sweep = (peer.sweep + 1) % peer.map.size();
    const PeerLandmark& l = peer.map[slot];
    if (l.present) {
      const TwinSearch near = look_around(h, peer.map, slot, map);
      peer.swept.expected += near.any_near() ? 1 : 0;
      peer.swept.hits += near.alike() >= 0 ? 1 : 0;
      int partner = near.alike();
      if (partner < 0 && peer.merged && near.one_corner() >= 0 &&
          !has_partner(h, near.one_corner(), slot)) {
        partner = near.one_corner();
      }
      if (partner >= 0) confirm_pair(h, {partner, map.info(partner).id, slot, l.id, 1});
    }
    if (peer.sweep == 0) break;  // a walk is over
  }
}

}  // namespace zenith
