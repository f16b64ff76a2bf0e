#include "slam/fleet/peer_map.h"

#include <algorithm>

#include "slam/bounds.h"

namespace zenith {
namespace {

bool plausible(const LandmarkRecord& r) {
  const auto near = [](float x) { return is_within(static_cast<double>(x), kFarthest_m); };
  if (!near(r.x_m) || !near(r.y_m) || !near(r.z_m)) return false;
  for (const float c : r.covariance_m2) {
    if (!near(c)) return false;
  }
  if (!is_covariance(r.covariance_m2)) return false;
  if (r.appearance_count > kPublishedAppearances) return false;
  for (int i = 0; i < r.appearance_count; ++i) {
    if (!near(r.appearances[static_cast<std::size_t>(i)].direction_rad)) return false;
  }
  return true;
}

}  // namespace

void PeerMap::layout(Arena& arena, PeerLandmarkPool& pool) {
  pool_ = &pool;
  slot_of_ = arena.take<std::int16_t>(kBuckets);
}

void PeerMap::clear() {
  for (int i = 0; i < block_count_; ++i) {
    pool_->give_back(block_numbers_[static_cast<std::size_t>(i)]);
  }
  block_count_ = 0;
  count_ = 0;
  std::fill(slot_of_.begin(), slot_of_.end(), std::int16_t{0});
}

std::size_t PeerMap::bucket(std::uint32_t id) const {
  std::size_t b = home_of(id);
  while (slot_of_[b] != 0 && (*this)[slot_of_[b] - 1].id != id) b = (b + 1) % kBuckets;
  return b;
}

// A slot that holds no landmark yet, or -1.
int PeerMap::new_slot() {
  if (count_ == kMaxPeerLandmarks) return -1;
  if (count_ == block_count_ * kPeerBlock) {
    const int block = pool_->take();
    if (block < 0) return -1;
    block_numbers_[static_cast<std::size_t>(block_count_)] = static_cast<std::int16_t>(block);
    blocks_[static_cast<std::size_t>(block_count_++)] = &pool_->block(block);
  }
  return count_++;
}

// The slot of a new landmark, or -1 when the map is full of present ones.
int PeerMap::enter(std::uint32_t id) {
  int slot = new_slot();
  if (slot < 0) {
    for (slot = 0; slot < count_ && (*this)[slot].present;) ++slot;
    if (slot == count_) return -1;
    forget((*this)[slot].id);
    block_of(slot).make_looks(slot % kPeerBlock, 0);
  }
  at(slot) = PeerLandmark{};
  at(slot).id = id;
  slot_of_[bucket(id)] = static_cast<std::int16_t>(slot + 1);
  return slot;
}

// Takes an id out of the hash table; those behind it move up, so that they are still found.
void PeerMap::forget(std::uint32_t id) {
  std::size_t hole = bucket(id);
  for (std::size_t b = (hole + 1) % kBuckets; slot_of_[b] != 0; b = (b + 1) % kBuckets) {
    const std::size_t home = home_of((*this)[slot_of_[b] - 1].id);
    const bool reachable = (b + kBuckets - home) % kBuckets < (b + kBuckets - hole) % kBuckets;
    if (reachable) continue;
    slot_of_[hole] = slot_of_[b];
    hole = b;
  }
  slot_of_[hole] = 0;
}

bool PeerMap::apply(const LandmarkRecord& r) {
  if (!plausible(r)) {
    ++rejected_;
    return false;
  }
  const std::size_t b = bucket(r.id);
  const int slot = slot_of_[b] != 0 ? slot_of_[b] - 1 : enter(r.id);
  if (slot < 0) {
    ++rejected_;
    return false;
  }
  PeerLandmark& l = at(slot);
  if (l.revision >= r.revision && l.revision != 0) return true;  // old news
  l.revision = r.revision;
  l.present = !r.removed;
  l.x_m = r.x_m;
  l.y_m = r.y_m;
  l.z_m = r.z_m;
  l.covariance_m2 = r.covariance_m2;
  l.observations = r.observations;
  const auto looks = block_of(slot).make_looks(slot % kPeerBlock, r.appearance_count);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    looks[i] = {compact_from(r.appearances[i].descriptor), r.appearances[i].direction_rad};
  }
  return true;
}

}  // namespace zenith
