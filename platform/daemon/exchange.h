#pragma once
// What the perception and the cooperation thread hand to each other: bounded queues of plain data.
// Perception never waits for them; what finds no place stays with its owner and comes later.

#include <cstdint>

#include "platform/linux/spsc_queue.h"
#include "slam/fleet/record.h"
#include "slam/geometry.h"

namespace zenith {

struct PeerRecord {
  int peer = 0;  // slot, below kMaxPeers
  LandmarkRecord record;
};

// A robot has merged: its T takes the peer's coordinates into its own.
struct MergeNews {
  int peer = 0;
  Pose2 T_own_peer;
};

struct Exchange {
  static constexpr std::size_t kRecords = 1024;  // 360 kB; a second's news of nine busy robots

  SpscQueue<LandmarkRecord, kRecords> own;  // perception -> cooperation
  SpscQueue<MergeNews, 64> own_merges;      // perception -> cooperation
  SpscQueue<PeerRecord, kRecords> peers;    // cooperation -> perception
  SpscQueue<MergeNews, 64> merges_with_us;  // cooperation -> perception; T_own_peer is ours
};

}  // namespace zenith
