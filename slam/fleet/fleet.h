#pragma once
// The peers: their maps, the search for overlaps, the hypotheses, the merge (paper III).
//
// Publish and receive are apart: own records leave through publish_changes(), peers' records enter
// through receive(). Nothing of a peer is ever written into the own map; the common map is made by
// reading (fusion.h), and a withdrawn peer is a forgotten term.

#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/alignment.h"
#include "slam/fleet/hough.h"
#include "slam/fleet/overlap.h"
#include "slam/fleet/peer.h"
#include "slam/parameters.h"

namespace zenith {

// What an alignment must show before it is acted upon, and when it has failed.
struct DecisionSettings {
  double confidence = 0.5;   // Eq. 4
  double score = 80.0;       // log odds, see Hypothesis::score()
  double rival_share = 0.5;  // a rival with this share of the leader's score: ambiguous
  int min_searches = 4;
  double min_way_m = 5.0;  // driven by this robot: a small map cannot show that it repeats itself
  // A stored map is whole: where it repeats itself its own rivals say so.
  double min_way_past_m = 0.6;
  double score_past = 12.0;  // docs/map-on-disk.md: how often it is right
  int min_pairs = 15;
  double withdraw_share = 0.3;    // of the expected landmarks found: no better than a wrong one
  double beaten_hit_share = 0.5;  // enough against the leader when a rival could be merged
  int withdraw_expected = 120;    // landmarks that could have been found, before it is judged
  // The own map explains the frame from another place about as well: a ceiling that repeats itself
  // cannot tell where along the repetition the robot is.
  double alike_hit_share = 0.72;
  double alike_expected_share = 0.4;  // of what the leader expects
  // Map against map: of the peer's landmarks that have any own one near, so many must be found.
  double map_hit_share = 0.6;
};

class Fleet {
 public:
  void layout(Arena& arena);
  void build(const Parameters& parameters);

  void receive(int peer, std::span<const LandmarkRecord> records);
  // What this peer tells is the robot's own map of an earlier run.
  void note_past(int peer) { peers_[static_cast<std::size_t>(peer)].past = true; }
  // The peer has merged with this robot: T takes its coordinates into the own ones. Not believed
  // but tested, map against map; both robots then go on in the common map at about the same time.
  void offer_alignment(int peer, const Pose2& T_own_peer);
  // What this robot publishes: its own map as others know it, to see where it repeats itself.
  void receive_own(std::span<const LandmarkRecord> records);

  // The peer's map and all that was made of it; its slot may become another peer's.
  void forget(int peer) { peers_[static_cast<std::size_t>(peer)].forget(); }

  // One used frame of the robot. Searches when it has moved far enough since the last search.
  void update(const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot,
              double travelled_m);
  // A frame in which the robot stood: only the maps are compared.
  void rest(const Map& map);

  std::span<const Alignment> alignments() const { return alignments_.span(); }
  std::uint64_t records_refused() const { return records_refused_; }
  std::span<const Peer> peers() const { return peers_.first(kMaxPeers); }

 private:
  void schedule(double travelled_m);
  double least_way_m(const Peer& peer) const {
    return peer.past ? decision_.min_way_past_m : decision_.min_way_m;
  }
  void compare_maps(const Map& map);
  bool own_map_repeats(const Hypothesis& leader) const;
  void put_to_test(Peer& peer, int hypothesis);
  void judge_offer(Peer& peer);
  void search(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot);
  void propose(Peer& peer, const ObservedFrame& frame, const Pose2& T_own_robot);
  void test(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot);
  static void drop_twins(Peer& peer, const Eigen::Vector2d& at);
  void decide(Peer& peer, const Pose2& T_own_robot);
  Peer& self() { return peers_[kMaxPeers]; }
  const Peer& self() const { return peers_[kMaxPeers]; }
  bool is_self(const Peer& peer) const { return &peer == &self(); }
  void report();

  OverlapSettings overlap_;
  HoughSettings hough_settings_;
  TestSettings test_;
  DecisionSettings decision_;
  double search_distance_m_ = 0.2;
  double searched_at_m_ = -1e9;
  double travelled_m_ = 0.0;
  HoughSearch hough_;
  PeerLandmarkPool landmarks_;
  HypothesisPool hypotheses_;
  std::span<Peer> peers_;     // kMaxPeers, and the robot itself behind them
  std::size_t searched_ = 0;  // peer whose turn it was
  std::size_t compared_ = 0;
  std::span<OverlapMatches> matches_;
  std::span<PlaceFixes> fixes_;
  FixedVector<Alignment, kMaxPeers> alignments_;
  std::uint64_t records_refused_ = 0;
};

}  // namespace zenith
