#include "slam/fleet/peer.h"

#include <algorithm>
#include <cassert>
#include <new>

namespace zenith {
namespace {

// Which hypothesis to give up when there is no room: first those that no longer say anything about
// what is in view, then the least likely.
double worth(const Hypothesis& h) {
  constexpr int kFewExpected = 25;
  constexpr double kNothing = -1e6;
  const bool tells = h.expected() >= kFewExpected || h.evidence.searches() < Evidence::kWindow;
  return tells ? h.score() : kNothing + h.score();
}

}  // namespace

void HypothesisPool::layout(Arena& arena) {
  pairs_.layout(arena);
  all_ = arena.take<Hypothesis>(kHypothesisPool);
  free_ = arena.take<std::int16_t>(kHypothesisPool);
  free_count_ = free_.size();
  for (std::size_t i = 0; i < free_.size(); ++i) {
    free_[i] = static_cast<std::int16_t>(free_.size() - 1 - i);
  }
}

int HypothesisPool::limit() const {
  return free_count_ > kHypothesisReserve ? kMaxHypotheses : kFewHypotheses;
}

Hypothesis* HypothesisPool::take() {
  assert(free_count_ > 0);
  if (free_count_ == 0) return nullptr;
  Hypothesis* h = new (&all_[static_cast<std::size_t>(free_[--free_count_])]) Hypothesis;
  h->pairs.use(pairs_);
  return h;
}

void HypothesisPool::give_back(Hypothesis* hypothesis) {
  hypothesis->pairs.clear();
  free_[free_count_++] = static_cast<std::int16_t>(hypothesis - all_.data());
}

void Peer::layout(Arena& arena, PeerLandmarkPool& landmarks, HypothesisPool& pool) {
  map.layout(arena, landmarks);
  pairs = arena.take<Correspondence>(kMaxCorrespondences);
  pool_ = &pool;
}

void Peer::forget() {
  map.clear();
  for (int i = 0; i < kMaxHypotheses; ++i) drop(i);
  known = false;
  past = false;
  alignment = {};
  leader = -1;
  merged = false;
  pair_count = 0;
  search_due = false;
  sweep = 0;
  swept = {};
  offered = -1;
}

// A free place, or that of the one to give up.
int Peer::place_for_one() const {
  int used = 0;
  int free = -1;
  int least = -1;
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Hypothesis* h = hypotheses[static_cast<std::size_t>(i)];
    if (h == nullptr) {
      if (free < 0) free = i;
      continue;
    }
    ++used;
    if (i == leader || i == offered) continue;
    if (least < 0 || worth(*h) < worth(*hypotheses[static_cast<std::size_t>(least)])) least = i;
  }
  return free >= 0 && (used < pool_->limit() || least < 0) ? free : least;
}

int Peer::add(const Pose2& T_own_peer) {
  const int place = place_for_one();
  if (place < 0) return -1;
  drop(place);
  Hypothesis* h = pool_->take();
  if (h == nullptr) return -1;
  h->T_own_peer = T_own_peer;
  h->covariance = Eigen::Vector3d(0.0025, 0.0025, 0.0004).asDiagonal();
  hypotheses[static_cast<std::size_t>(place)] = h;
  return place;
}

void Peer::drop(int place) {
  Hypothesis*& h = hypotheses[static_cast<std::size_t>(place)];
  if (h != nullptr) pool_->give_back(h);
  h = nullptr;
  if (place == leader) leader = -1;
  if (place == offered) offered = -1;
}

}  // namespace zenith
