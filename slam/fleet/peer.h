#pragma once
// One peer as this robot knows it: its map, the alignments that are possible, what became of them.

#include <array>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/alignment.h"
#include "slam/fleet/hypothesis.h"
#include "slam/fleet/peer_map.h"

namespace zenith {

// Hypotheses for all peers; see capacity.h for who may have how many.
class HypothesisPool {
 public:
  void layout(Arena& arena);

  // A fresh one, or null. Never runs dry while all keep to limit().
  Hypothesis* take();
  void give_back(Hypothesis* hypothesis);
  int limit() const;  // that one peer may have now

 private:
  PairPool pairs_;
  std::span<Hypothesis> all_;
  std::span<std::int16_t> free_;
  std::size_t free_count_ = 0;
};

class Peer {
 public:
  void layout(Arena& arena, PeerLandmarkPool& landmarks, HypothesisPool& pool);

  // As if it had never been heard of.
  void forget();

  // A new hypothesis in a free place, or in that of the one that is worth least; its place, or -1.
  int add(const Pose2& T_own_peer);
  void drop(int place);
  // Of a place that is in use.
  Hypothesis& hypothesis(int place) { return *hypotheses[static_cast<std::size_t>(place)]; }

  PeerMap map;
  bool known = false;
  bool past = false;    // this robot's own stored map: whole from the start, and never changes
  Alignment alignment;  // of the leading hypothesis, or the merged one
  int leader = -1;
  bool merged = false;
  std::array<Hypothesis*, kMaxHypotheses> hypotheses = {};  // null: a free place
  std::span<Correspondence> pairs;                          // of the leader, for readers
  std::size_t pair_count = 0;
  bool search_due = false;

  // The search for duplicates walks through the peer's landmarks.
  int sweep = 0;
  Support swept;     // of this walk
  int offered = -1;  // hypothesis under test: the leader, or what the peer says

 private:
  int place_for_one() const;

  HypothesisPool* pool_ = nullptr;
};

}  // namespace zenith
