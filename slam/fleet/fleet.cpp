#include "slam/fleet/fleet.h"

#include <algorithm>
#include <cmath>

#include "slam/fleet/duplicates.h"

namespace zenith {
namespace {

// Merged or tested peers whose maps are compared with the own one in a frame: bounded work.
constexpr std::size_t kComparedPerFrame = 8;
constexpr double kPairsAlike = 10.0;

}  // namespace

void Fleet::layout(Arena& arena) {
  arena.part("peers: overlap search");
  hough_.layout(arena);
  matches_ = arena.take<OverlapMatches>(1);
  fixes_ = arena.take<PlaceFixes>(1);
  arena.part("peers: landmarks and their looks");
  landmarks_.layout(arena);
  arena.part("peers: hypotheses and their pairs");
  hypotheses_.layout(arena);
  arena.part("peers: lists, and tables of ids");
  peers_ = arena.take<Peer>(kMaxPeers + 1);
  for (int i = 0; i < kMaxPeers + 1; ++i) {
    Peer scratch;
    Peer& peer = arena.counting() ? scratch : peers_[static_cast<std::size_t>(i)];
    peer.layout(arena, landmarks_, hypotheses_);
  }
}

void Fleet::build(const Parameters& parameters) {
  overlap_.ncc_min = static_cast<float>(parameters.ncc_overlap);
  decision_.confidence = parameters.confidence_threshold;
}

void Fleet::receive(int peer, std::span<const LandmarkRecord> records) {
  Peer& p = peers_[static_cast<std::size_t>(peer)];
  p.known = true;
  for (const LandmarkRecord& r : records) records_refused_ += p.map.apply(r) ? 0 : 1;
}

void Fleet::receive_own(std::span<const LandmarkRecord> records) {
  self().known = true;
  for (const LandmarkRecord& r : records) records_refused_ += self().map.apply(r) ? 0 : 1;
}

void Fleet::offer_alignment(int peer_slot, const Pose2& T_own_peer) {
  Peer& peer = peers_[static_cast<std::size_t>(peer_slot)];
  if (!peer.known || peer.map.empty() || peer.merged) return;
  if (peer.offered >= 0) return;  // one is under test
  const int added = peer.add(T_own_peer);
  if (added >= 0) put_to_test(peer, added);
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
  // One search a frame, all in turn: the work of a frame does not grow with the number of peers.
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    searched_ = (searched_ + 1) % peers_.size();
    Peer& peer = peers_[searched_];
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
  std::size_t compared = 0;
  for (std::size_t i = 0; i < kMaxPeers && compared < kComparedPerFrame; ++i) {
    compared_ = (compared_ + 1) % kMaxPeers;
    Peer& peer = peers_[compared_];
    const int subject = peer.merged ? peer.leader : peer.offered;
    if (subject < 0) continue;
    ++compared;
    search_duplicates(peer, subject, map);
    if (!peer.merged) judge_offer(peer);
  }
}

bool Fleet::own_map_repeats(const Hypothesis& leader) const {
  for (const Hypothesis* h : self().hypotheses) {
    if (h != nullptr && h->expected() > decision_.alike_expected_share * leader.expected() &&
        h->hits() > decision_.alike_hit_share * h->expected()) {
      return true;
    }
  }
  return false;
}

// After a walk through the whole of the peer's map.
void Fleet::judge_offer(Peer& peer) {
  if (peer.sweep != 0 || peer.swept.expected == 0) return;
  const int place = peer.offered;
  const Hypothesis& h = peer.hypothesis(place);
  const bool right = peer.swept.hits >= decision_.min_pairs &&
                     peer.swept.hits > decision_.map_hit_share * peer.swept.expected &&
                     travelled_m_ >= least_way_m(peer) && !own_map_repeats(h);
  peer.offered = -1;
  peer.swept = {};
  if (!right) {
    // Its own frames may still speak for it, and later the maps.
    if (h.score() <= 0.0) peer.drop(place);
    return;
  }
  peer.leader = place;
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
  hough_.find_places(matches_[0], hough_settings_, fixes_[0]);
  for (const PlaceFix& fix : fixes_[0]) {
    const Pose2 T_own_peer = T_own_robot * fix.T_peer_robot.inverse();
    if (is_self(peer) && same_alignment(T_own_peer, {}, T_own_robot.position())) continue;
    const bool known =
        std::any_of(peer.hypotheses.begin(), peer.hypotheses.end(), [&](const Hypothesis* h) {
          return h != nullptr && same_alignment(h->T_own_peer, T_own_peer, T_own_robot.position());
        });
    if (!known) peer.add(T_own_peer);
  }
}

void Fleet::test(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot) {
  for (int place = 0; place < kMaxHypotheses; ++place) {
    if (peer.hypotheses[static_cast<std::size_t>(place)] == nullptr) continue;
    Hypothesis& h = peer.hypothesis(place);
    const FrameTest result = test_hypothesis(h, frame, peer.map, T_own_robot, test_);
    const Eigen::Vector2d at = rotation(h.T_own_peer.theta_rad) * result.T_peer_robot.position();
    h.confidence.add(T_own_robot.position(), at, result.found);
    refit(h, map, peer.map);
    const bool held = (peer.merged && place == peer.leader) || place == peer.offered;
    const bool nothing = !held && h.evidence.searches() >= Evidence::kWindow && h.hits() == 0;
    const bool itself = is_self(peer) && same_alignment(h.T_own_peer, {}, T_own_robot.position());
    if (nothing || itself) peer.drop(place);
  }
  drop_twins(peer, T_own_robot.position());
}

// Two hypotheses that have become the same are one: the better supported stays.
void Fleet::drop_twins(Peer& peer, const Eigen::Vector2d& at) {
  const auto& all = peer.hypotheses;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    for (int k = i + 1; k < kMaxHypotheses; ++k) {
      const Hypothesis* a = all[static_cast<std::size_t>(i)];
      const Hypothesis* b = all[static_cast<std::size_t>(k)];
      if (a == nullptr) break;
      if (b == nullptr || i == peer.offered || k == peer.offered) continue;
      if (!same_alignment(a->T_own_peer, b->T_own_peer, at)) continue;
      const bool keep_a = i == peer.leader || (k != peer.leader && a->hits() >= b->hits());
      peer.drop(keep_a ? k : i);
    }
  }
}

void Fleet::decide(Peer& peer, const Pose2& T_own_robot) {
  int best = -1;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Hypothesis* h = peer.hypotheses[static_cast<std::size_t>(i)];
    if (h == nullptr) continue;
    if (best < 0 || h->score() > peer.hypothesis(best).score()) best = i;
  }
  if (!peer.merged) peer.leader = best;
  if (peer.leader < 0) return;
  const Hypothesis& leader = peer.hypothesis(peer.leader);
  const Hypothesis* rival = nullptr;
  for (const Hypothesis* h : peer.hypotheses) {
    if (h == &leader || h == nullptr) continue;
    if (same_alignment(h->T_own_peer, leader.T_own_peer, T_own_robot.position())) continue;
    if (rival == nullptr || h->score() > rival->score()) rival = h;
  }
  const double rival_score = rival == nullptr ? 0.0 : std::max(rival->score(), 0.0);
  const DecisionSettings& d = decision_;
  if (!peer.merged) {
    const double score = peer.past ? d.score_past : d.score;
    const EvidenceStandard standard = {d.confidence, score, d.rival_share, d.min_searches};
    const bool ready = convinces(leader.score(), leader.evidence.searches(),
                                 leader.confidence.value(), rival_score, standard) &&
                       travelled_m_ >= least_way_m(peer) &&
                       static_cast<int>(leader.pairs.size()) >= d.min_pairs &&
                       !own_map_repeats(leader);
    if (ready && peer.offered < 0) put_to_test(peer, peer.leader);
    return;
  }
  const bool refuted = leader.expected() >= d.withdraw_expected &&
                       leader.hits() < d.withdraw_share * leader.expected();
  const bool beaten = rival_score > d.score && leader.expected() >= d.withdraw_expected / 2 &&
                      leader.hits() < d.beaten_hit_share * leader.expected();
  if (refuted || beaten) {
    peer.drop(peer.leader);
    peer.merged = false;
    peer.alignment.state = AlignmentState::kWithdrawn;
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
    const Hypothesis& h = peer.hypothesis(peer.leader);
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
