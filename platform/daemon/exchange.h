#pragma once
// What the perception and the cooperation thread hand to each other: bounded queues and snapshots
// of plain data. Perception never waits for them; what finds no place stays with its owner and
// comes later.

#include <cstdint>

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

// What people who look are shown of the maps: a landmark that is new or changed, or is no more.
struct MapNews {
  enum class Kind : std::uint8_t {
    kLandmark,
    kRemoved,
    kForget,  // the whole map of this peer
  };
  static constexpr int kOwn = -1;
  int owner = kOwn;  // or a peer's slot; coordinates are the owner's own
  Kind kind = Kind::kLandmark;
  std::uint32_t id = 0;
  std::array<float, 3> position_m = {};
  std::array<float, 4> variance_m2 = {};  // xx xy yy zz
  int observations = 0;
};

inline MapNews map_news(int owner, const LandmarkRecord& record) {
  const auto& c = record.covariance_m2;
  return {owner,
          record.removed ? MapNews::Kind::kRemoved : MapNews::Kind::kLandmark,
          record.id,
          {record.x_m, record.y_m, record.z_m},
          {c[0], c[1], c[3], c[5]},
          record.observations};
}

struct Exchange {
  static constexpr std::size_t kRecords = 1024;  // 360 kB; a second's news of nine busy robots

  SpscQueue<LandmarkRecord, kRecords> own;   // perception -> cooperation
  Snapshot<OwnState> own_state;              // perception -> cooperation
  SpscQueue<PeerNews, kRecords> peers;       // cooperation -> perception
  SpscQueue<MergeNews, 128> merges_with_us;  // cooperation -> perception

  // What finds no place in it waits with the records. 200 kB; four seconds' news.
  SpscQueue<MapNews, 4096> shown;  // cooperation -> housekeeping
  std::size_t room_to_show() const { return shown.capacity() - shown.size(); }
};

}  // namespace zenith
