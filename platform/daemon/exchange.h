#pragma once
// What the perception and the cooperation thread hand to each other: bounded queues and snapshots
// of plain data. Perception never waits for them; what finds no place stays with its owner and
// comes later.

#include <cstdint>

#include "platform/daemon/map_lines.h"
#include "platform/daemon/perception_report.h"
#include "platform/linux/snapshot.h"
#include "platform/linux/spsc_queue.h"
#include "slam/fleet/record.h"
#include "slam/geometry.h"

namespace zenith {

// In the order in which it happened. A peer has one slot, below kMaxPeers, as long as its map is
// kept.
struct PeerNews {
  enum class Kind : std::uint8_t {
    kRecord,
    kForget,  // the map in this slot is no more; what follows belongs to another one
  };
  int peer = 0;
  Kind kind = Kind::kRecord;
  LandmarkRecord record;
};

// A peer has merged with this robot: T takes the peer's coordinates into the own ones.
struct MergeNews {
  int peer = 0;
  Pose2 T_own_peer;
};

// What peers are told of this robot besides its landmarks.
struct OwnState {
  bool has_pose = false;
  Pose2 T_start_robot;
  FixedVector<PeerReport, kMaxPeers> peers;
};

struct Exchange {
  static constexpr std::size_t kRecords = 1024;  // 360 kB; a second's news of nine busy robots

  SpscQueue<LandmarkRecord, kRecords> own;   // perception -> cooperation
  Snapshot<OwnState> own_state;              // perception -> cooperation
  SpscQueue<PeerNews, kRecords> peers;       // cooperation -> perception
  SpscQueue<MergeNews, 128> merges_with_us;  // cooperation -> perception

  // What people who look are shown. It takes everything, at once: they hold nothing up.
  MapLines shown;  // cooperation -> housekeeping
};

}  // namespace zenith
