#pragma once
// One peer's published map as this robot keeps it: the highest revision of each landmark.
// Removed landmarks are remembered, so that a late record does not bring them back, until their
// room is needed. Full of present ones, or no room in the pool: new landmarks are rejected and
// counted.

#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/fleet/peer_landmark.h"
#include "slam/fleet/record.h"

namespace zenith {

class PeerMap {
 public:
  // `pool` must outlive the map and stay where it is.
  void layout(Arena& arena, PeerLandmarkPool& pool);

  // False when the record was refused: not finite, absurd, or no room.
  bool apply(const LandmarkRecord& record);
  // All landmarks at once; their room is free for others.
  void clear();

  // Slots below size() hold landmarks, present or removed; a landmark keeps its slot as long as it
  // is remembered.
  int size() const { return count_; }
  const PeerLandmark& operator[](int slot) const { return block_of(slot)[slot % kPeerBlock]; }
  // At most kPublishedAppearances; fewer than the peer told when its block is full of looks.
  std::span<const PeerAppearance> looks(int slot) const {
    return block_of(slot).looks(slot % kPeerBlock);
  }
  bool empty() const { return count_ == 0; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  static constexpr std::size_t kMaxBlocks = kMaxPeerLandmarks / kPeerBlock;
  static constexpr std::size_t kBuckets = 2 * kMaxPeerLandmarks;  // open addressing, half full
  static std::size_t home_of(std::uint32_t id) {
    return (id * 2654435761U) % kBuckets;  // Knuth's multiplicative hash
  }
  PeerLandmarkBlock& block_of(int slot) const {
    return *blocks_[static_cast<std::size_t>(slot / kPeerBlock)];
  }
  PeerLandmark& at(int slot) { return block_of(slot)[slot % kPeerBlock]; }
  std::size_t bucket(std::uint32_t id) const;  // where it stands, or the free one where it would
  int new_slot();
  int enter(std::uint32_t id);
  void forget(std::uint32_t id);

  PeerLandmarkPool* pool_ = nullptr;
  std::array<PeerLandmarkBlock*, kMaxBlocks> blocks_ = {};
  std::array<std::int16_t, kMaxBlocks> block_numbers_ = {};
  int block_count_ = 0;
  int count_ = 0;
  std::span<std::int16_t> slot_of_;  // bucket -> slot + 1, 0: free
  std::uint64_t rejected_ = 0;
};

}  // namespace zenith
