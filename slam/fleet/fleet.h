#pragma once
// The peers: their maps, the search for overlaps, the hypotheses, the merge (paper III).
//
// Publish and receive are apart: own records leave through publish_changes(), peers' records enter
// through receive(). Nothing of a peer is ever written into the own map; the common map is made by
// reading (fusion.h), and a withdrawn peer is a forgotten term.

#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/hough.h"
#include "slam/fleet/hypothesis.h"
#include "slam/fleet/overlap.h"
#include "slam/fleet/peer_map.h"
#include "slam/parameters.h"
#include "slam/slam.h"

namespace zenith {

// What an alignment must show before it is acted upon, and when it has failed.
struct DecisionSettings {
  double confidence = 0.5;       // Eq. 4
  double score = 45.0;           // log odds, see Hypothesis::score()
  double rival_share = 0.5;      // a rival with this share of the leader's score: ambiguous
  int min_searches = 4;
  int min_pairs = 15;
  double withdraw_share = 0.3;   // of the expected landmarks found: no better than a wrong one
  int withdraw_expected = 120;   // landmarks that could have been found, before it is judged
};

class Peer {
 public:
  void layout(Arena& arena);

  PeerMap map;
  bool known = false;
  Alignment alignment;  // of the leading hypothesis, or the merged one
  int leader = -1;
  bool merged = false;
  std::span<Hypothesis> hypotheses;   // kMaxHypotheses
  std::span<Correspondence> pairs;    // of the leader, for readers
  std::size_t pair_count = 0;
  int sweep = 0;                      // next peer landmark of the search for duplicates
};

class Fleet {
 public:
  void layout(Arena& arena);
  void build(const Parameters& parameters);

  void receive(int peer, std::span<const LandmarkRecord> records);

  // One used frame of the robot. Searches when it has moved far enough since the last search.
  void update(const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot,
              double travelled_m);

  std::span<const Alignment> alignments() const { return alignments_.span(); }
  std::span<const Peer> peers() const { return peers_; }

 private:
  void search(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot);
  void propose(Peer& peer, const ObservedFrame& frame, const Pose2& T_own_robot);
  void test(Peer& peer, const ObservedFrame& frame, const Map& map, const Pose2& T_own_robot);
  void decide(Peer& peer, const Pose2& T_own_robot);
  void search_duplicates(Peer& peer, const Map& map);
  void report();

  OverlapSettings overlap_;
  HoughSettings hough_settings_;
  TestSettings test_;
  DecisionSettings decision_;
  double search_distance_m_ = 0.2;
  double searched_at_m_ = -1e9;
  HoughSearch hough_;
  std::span<Peer> peers_;
  std::span<OverlapMatches> matches_;
  std::span<PlaceFixes> fixes_;
  FixedVector<Alignment, kMaxPeers> alignments_;
};

}  // namespace zenith
