#include "slam/fleet/fleet.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "slam/image/ncc.h"

namespace zenith {
namespace {

// Peer's landmarks looked at in one frame by the search for duplicates: bounded work each frame.
constexpr int kSweepPerFrame = 96;
constexpr float kDuplicateNcc = 0.6F;
constexpr double kPairsAlike = 10.0;
constexpr double kDuplicateSigmas = 3.0;
// Errors of the maps that the landmarks' covariances do not tell: their drift in common.
constexpr double kMapError_m = 0.025;

// Which hypothesis to give up when there is no room: first those that no longer say anything about
// what is in view, then the least likely.
double worth(const Hypothesis& h) {
  constexpr int kFewExpected = 25;
  constexpr double kNothing = -1e6;
  const bool tells = h.expected() >= kFewExpected || h.searches < Hypothesis::kWindow;
  return tells ? h.score() : kNothing + h.score();
}

// Whether two landmarks `d` apart lie within the uncertainty of both (P: the peer's, transformed).
bool may_be_one(const Eigen::Matrix2d& P, const LandmarkInfo& own, const Eigen::Vector2d& d) {
  const Eigen::Matrix2d S = P + own.covariance().topLeftCorner<2, 2>() +
                            kMapError_m * kMapError_m * Eigen::Matrix2d::Identity();
  return d.dot(S.inverse() * d) < kDuplicateSigmas * kDuplicateSigmas;
}

// Of corners that are told apart by their looks alone, two within kOneCorner_m of each other are
// one once the maps are merged: a detector keeps corners further apart than that.
constexpr double kOneCorner_m = 0.05;

bool has_partner(const Hypothesis& h, int own_slot, int peer_slot) {
  return std::any_of(h.pairs.begin(), h.pairs.end(), [&](const LandmarkPair& p) {
    return p.own_slot == own_slot || p.peer_slot == peer_slot;
  });
}

// The index of a free hypothesis, or of the one to give up.
int give_up_one(const Peer& peer) {
  int place = -1;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Hypothesis& h = peer.hypotheses[static_cast<std::size_t>(i)];
    if (!h.used) return i;
    if (i == peer.leader || i == peer.offered) continue;
    if (place < 0 || worth(h) < worth(peer.hypotheses[static_cast<std::size_t>(place)])) place = i;
  }
  return place;
}

}  // namespace

void Peer::layout(Arena& arena) {
  map.layout(arena);
  hypotheses = arena.take<Hypothesis>(kMaxHypotheses);
  pairs = arena.take<Correspondence>(kMaxCorrespondences);
}

void Fleet::layout(Arena& arena) {
  hough_.layout(arena);
  matches_ = arena.take<OverlapMatches>(1);
  fixes_ = arena.take<PlaceFixes>(1);
  peers_ = arena.take<Peer>(kMaxPeers + 1);
  for (int i = 0; i < kMaxPeers + 1; ++i) {
    Peer scratch;
    (arena.counting() ? scratch : peers_[static_cast<std::size_t>(i)]).layout(arena);
  }
}

void Fleet::build(const Parameters& parameters) {
  overlap_.ncc_min = static_cast<float>(parameters.ncc_overlap);
  decision_.confidence = parameters.confidence_threshold;
}

void Fleet::receive(int peer, std::span<const LandmarkRecord> records) {
  Peer& p = peers_[static_cast<std::size_t>(peer)];
  p.known = true;
  for (const LandmarkRecord& r : records) p.map.apply(r);
}

void Fleet::receive_own(std::span<const LandmarkRecord> records) {
  self().known = true;
  for (const LandmarkRecord& r : records) self().map.apply(r);
}

void Fleet::offer_alignment(int peer_slot, const Pose2& T_own_peer) {
  Peer& peer = peers_[static_cast<std::size_t>(peer_slot)];
  if (!peer.known || peer.map.empty() || peer.merged) return;
  if (peer.offered >= 0) return;  // one is under test
  Hypothesis& h = peer.hypotheses[static_cast<std::size_t>(give_up_one(peer))];
  h = Hypothesis{};
  h.used = true;
  h.T_own_peer = T_own_peer;
  h.covariance = Eigen::Vector3d(0.0025, 0.0025, 0.0004).asDiagonal();
  put_to_test(peer, static_cast<int>(&h - peer.hypotheses.data()));
}

// The last word has the comparison of the whole maps: see judge_offer().
void Fleet::put_to_test(Peer& peer, int hypothesis) {
  peer.offered = hypothesis;
  peer.sweep = 0;
  peer.swept = {};
}

void Fleet::update(const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot,
                   double travelled_m) {
  travelled_m_ = travelled_m;
  schedule(travelled_m);
  // One search a frame: the work of a frame does not grow with the number of peers.
  for (Peer& peer : peers_) {
    if (!peer.search_due) continue;
    peer.search_due = false;
    search(peer, frame, map, T_own_robot);
    break;
  }
  compare_maps(map);
  report();
}

void Fleet::rest(const Map& map) {
  compare_maps(map);
  report();
}

void Fleet::schedule(double travelled_m) {
  if (travelled_m - searched_at_m_ < search_distance_m_) return;
  searched_at_m_ = travelled_m;
  bool undecided = false;
  for (Peer& peer : peers_.first(kMaxPeers)) {
    peer.search_due = peer.known && !peer.map.empty();
    undecided |= peer.search_due && !peer.merged;
  }
  self().search_due = undecided && self().known && !self().map.empty();
}

void Fleet::compare_maps(const Map& map) {
  for (Peer& peer : peers_.first(kMaxPeers)) {
    const int subject = peer.merged ? peer.leader : peer.offered;
    if (subject < 0) continue;
    search_duplicates(peer, map, peer.hypotheses[static_cast<std::size_t>(subject)]);
    if (!peer.merged) judge_offer(peer);
  }
}

bool Fleet::own_map_repeats(const Hypothesis& leader) const {
  for (const Hypothesis& h : self().hypotheses) {
    if (h.used && h.expected() > decision_.alike_expected_share * leader.expected() &&
        h.hits() > decision_.alike_hit_share * h.expected()) {
      return true;
    }
  }
  return false;
}

// After a walk through the whole of the peer's map.
void Fleet::judge_offer(Peer& peer) {
  if (peer.sweep != 0 || peer.swept.expected == 0) return;
  const auto index = static_cast<std::size_t>(peer.offered);
  Hypothesis& h = peer.hypotheses[index];
  const bool right = peer.swept.hits >= decision_.min_pairs &&
                     peer.swept.hits > decision_.map_hit_share * peer.swept.expected &&
                     travelled_m_ >= decision_.min_way_m && !own_map_repeats(h);
  peer.offered = -1;
  peer.swept = {};
  if (!right) {
    h.used = h.score() > 0.0;  // its own frames may still speak for it, and later the maps
    return;
  }
  peer.leader = static_cast<int>(index);
  peer.merged = true;
}

void Fleet::search(Peer& peer, const ObservedFrame& frame, const Map& map,
                   const Pose2& T_own_robot) {
  propose(peer, frame, T_own_robot);
  test(peer, frame, map, T_own_robot);
  if (!is_self(peer)) decide(peer, T_own_robot);
}

// New hypotheses from this frame alone.
void Fleet::propose(Peer& peer, const ObservedFrame& frame, const Pose2& T_own_robot) {
  find_overlap(frame, peer.map, overlap_, matches_[0]);
  hough_.find_places(frame, peer.map, matches_[0], hough_settings_, fixes_[0]);
  for (const PlaceFix& fix : fixes_[0]) {
    const Pose2 T_own_peer = T_own_robot * fix.T_peer_robot.inverse();
    if (is_self(peer) && same_alignment(T_own_peer, {}, T_own_robot.position())) continue;
    const auto known = std::find_if(peer.hypotheses.begin(), peer.hypotheses.end(), [&](auto& h) {
      return h.used && same_alignment(h.T_own_peer, T_own_peer, T_own_robot.position());
    });
    if (known != peer.hypotheses.end()) continue;
    Hypothesis* place = &peer.hypotheses[static_cast<std::size_t>(give_up_one(peer))];
    *place = Hypothesis{};
    place->used = true;
    place->T_own_peer = T_own_peer;
    place->covariance = Eigen::Vector3d(0.0025, 0.0025, 0.0004).asDiagonal();
  }
}

void Fleet::test(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot) {
  for (Hypothesis& h : peer.hypotheses) {
    if (!h.used) continue;
    const FrameTest result = test_hypothesis(h, frame, peer.map, T_own_robot, test_);
    const Eigen::Vector2d place = rotation(h.T_own_peer.theta_rad) * result.T_peer_robot.position();
    h.confidence.add(T_own_robot.position(), place, result.found);
    refit(h, map, peer.map);
    const auto index = static_cast<int>(&h - peer.hypotheses.data());
    const bool held = (peer.merged && index == peer.leader) || index == peer.offered;
    if (!held && h.searches >= Hypothesis::kWindow && h.hits() == 0) h.used = false;
    if (is_self(peer) && same_alignment(h.T_own_peer, {}, T_own_robot.position())) h.used = false;
  }
  // Two that have become the same are one: the better supported stays.
  for (std::size_t i = 0; i < peer.hypotheses.size(); ++i) {
    for (std::size_t k = i + 1; k < peer.hypotheses.size(); ++k) {
      Hypothesis& a = peer.hypotheses[i];
      Hypothesis& b = peer.hypotheses[k];
      if (!a.used || !b.used) continue;
      if (!same_alignment(a.T_own_peer, b.T_own_peer, T_own_robot.position())) continue;
      if (static_cast<int>(i) == peer.offered || static_cast<int>(k) == peer.offered) continue;
      const bool keep_a = static_cast<int>(i) == peer.leader ||
                          (static_cast<int>(k) != peer.leader && a.hits() >= b.hits());
      (keep_a ? b : a).used = false;
    }
  }
}

void Fleet::decide(Peer& peer, const Pose2& T_own_robot) {
  int best = -1;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Hypothesis& h = peer.hypotheses[static_cast<std::size_t>(i)];
    if (!h.used) continue;
    if (best < 0 || h.score() > peer.hypotheses[static_cast<std::size_t>(best)].score()) best = i;
  }
  if (!peer.merged) peer.leader = best;
  if (peer.leader < 0) return;
  const Hypothesis& leader = peer.hypotheses[static_cast<std::size_t>(peer.leader)];
  const Hypothesis* rival = nullptr;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Hypothesis& h = peer.hypotheses[static_cast<std::size_t>(i)];
    if (i == peer.leader || !h.used) continue;
    if (same_alignment(h.T_own_peer, leader.T_own_peer, T_own_robot.position())) continue;
    if (rival == nullptr || h.score() > rival->score()) rival = &h;
  }
  const double rival_score = rival == nullptr ? 0.0 : std::max(rival->score(), 0.0);
  const DecisionSettings& d = decision_;
  if (!peer.merged) {
    const bool ready = leader.confidence.value() > d.confidence && leader.score() > d.score &&
                       leader.searches >= d.min_searches && travelled_m_ >= d.min_way_m &&
                       static_cast<int>(leader.pairs.size()) >= d.min_pairs &&
                       rival_score < d.rival_share * leader.score() && !own_map_repeats(leader);
    if (ready && peer.offered < 0) put_to_test(peer, peer.leader);
    return;
  }
  const bool refuted = leader.expected() >= d.withdraw_expected &&
                       leader.hits() < d.withdraw_share * leader.expected();
  const bool beaten = rival_score > d.score && leader.expected() >= d.withdraw_expected / 2 &&
                      leader.hits() < d.beaten_hit_share * leader.expected();
  if (refuted || beaten) {
    peer.hypotheses[static_cast<std::size_t>(peer.leader)].used = false;
    peer.merged = false;
    peer.leader = -1;
    peer.alignment.state = AlignmentState::kWithdrawn;
  }
}

// Common landmarks that no frame has shown yet (paper III-C): within the uncertainty that the
// transform enlarges, a similar look makes a pair, and the next fit uses it.
void Fleet::search_duplicates(Peer& peer, const Map& map, Hypothesis& h) {
  const auto theirs = peer.map.landmarks();
  const auto own = map.landmarks();
  for (int n = 0; n < kSweepPerFrame; ++n) {
    const int slot_of_peer = peer.sweep;
    peer.sweep = (peer.sweep + 1) % static_cast<int>(theirs.size());
    const PeerLandmark& l = theirs[static_cast<std::size_t>(slot_of_peer)];
    if (!l.present) {
      if (peer.sweep == 0) break;
      continue;
    }
    const Eigen::Vector2d at = h.T_own_peer * l.xy();
    const Eigen::Matrix2d P =
        transform_covariance(h.T_own_peer, h.covariance, l.xy(), l.covariance_xy());
    const double reach = std::min(kDuplicateSigmas * std::sqrt(P.trace()) + 0.08, 0.4);
    int best_slot = -1;
    int nearest_slot = -1;
    double nearest = kOneCorner_m * kOneCorner_m;
    bool any = false;
    float best = kDuplicateNcc;
    for (std::size_t slot = 0; slot < own.size(); ++slot) {
      const LandmarkInfo& o = own[slot];
      const double dx = static_cast<double>(o.x_m) - at.x();
      const double dy = static_cast<double>(o.y_m) - at.y();
      if (dx * dx + dy * dy > 4.0 * reach * reach || o.state != LandmarkState::kPromoted) continue;
      if (std::abs(o.z_m - l.z_m) > 0.3F) continue;
      any = true;
      const double dz = static_cast<double>(o.z_m - l.z_m);
      const double apart = dx * dx + dy * dy + dz * dz;
      if (apart < nearest) {
        nearest = apart;
        nearest_slot = static_cast<int>(slot);
      }
      if (dx * dx + dy * dy > reach * reach || !may_be_one(P, o, {dx, dy})) continue;
      for (int i = o.first_appearance; i >= 0; i = map.appearance(i).next) {
        const Appearance& a = map.appearance(i);
        for (int k = 0; k < l.appearance_count; ++k) {
          const PeerAppearance& b = l.appearances[static_cast<std::size_t>(k)];
          const double turn = static_cast<double>(a.direction_rad - b.direction_rad);
          if (std::abs(wrap_angle(turn - h.T_own_peer.theta_rad)) > 0.5) continue;
          const float similarity = ncc(a.compact, b.compact);
          if (similarity <= best) continue;
          best = similarity;
          best_slot = static_cast<int>(slot);
        }
      }
    }
    peer.swept.expected += any ? 1 : 0;
    peer.swept.hits += best_slot >= 0 ? 1 : 0;
    const bool one_corner =
        peer.merged && nearest_slot >= 0 && !has_partner(h, nearest_slot, slot_of_peer);
    if (best_slot < 0 && one_corner) best_slot = nearest_slot;
    if (best_slot >= 0) {
      const std::uint32_t own_id = own[static_cast<std::size_t>(best_slot)].id;
      confirm_pair(h, {best_slot, own_id, slot_of_peer, l.id, 1});
    }
    if (peer.sweep == 0) break;  // a walk is over
  }
}

void Fleet::report() {
  alignments_.clear();
  for (std::size_t i = 0; i < kMaxPeers; ++i) {
    Peer& peer = peers_[i];
    if (!peer.known) continue;
    Alignment& a = peer.alignment;
    a.peer = static_cast<int>(i);
    peer.pair_count = 0;
    if (peer.leader < 0) {
      a.confidence = 0.0;
      a.correspondences = 0;
      if (a.state == AlignmentState::kWithdrawn) alignments_.push_back(a);
      continue;
    }
    const Hypothesis& h = peer.hypotheses[static_cast<std::size_t>(peer.leader)];
    a.state = peer.merged ? AlignmentState::kMerged : AlignmentState::kCandidate;
    a.T_own_peer = h.T_own_peer;
    // Landmarks of one stretch share its error: about so many tell one independent thing.
    a.covariance = h.covariance * std::max(1.0, static_cast<double>(h.pairs.size()) / kPairsAlike);
    a.confidence = h.confidence.value();
    a.correspondences = static_cast<int>(h.pairs.size());
    for (const LandmarkPair& p : h.pairs) {
      peer.pairs[peer.pair_count++] = {p.own_id, peer.map[p.peer_slot].id};
    }
    alignments_.push_back(a);
  }
}

}  // namespace zenith
