#pragma once
// Keeps the map across restarts: loads the stored one at the start, which perception gets as its
// past self, and writes checkpoints.
//
//   nothing stored                 the own map, in the own start frame
//   stored, robot not found yet    nothing: the stored map stays as it is
//   found itself                   both maps as one in the stored map's frame (continued_map.h)
//   kNewMap landmarks, not found   it is another place: the stored map is set aside, a new one
//   begins
//
// On a thread of its own: a slow card may take seconds to sync. What it needs of the own map it
// copies under a lock that is held for a millisecond at most and that perception never takes.

#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "platform/base/fixed_text.h"
#include "platform/base/time.h"
#include "platform/daemon/perception_report.h"
#include "platform/linux/snapshot.h"
#include "platform/storage/map_store.h"
#include "platform/storage/own_map.h"

namespace zenith {

struct MapStatus {
  bool failing = false;  // the last checkpoint could not be written
  FixedText<200> error;  // why
  std::uint64_t map = 0;
  std::uint64_t checkpoint = 0;  // the last one that is on the disk
  std::uint64_t written = 0;     // checkpoints of this run
  std::uint64_t failed = 0;
  std::uint64_t bytes = 0;      // of this run
  std::uint32_t landmarks = 0;  // of the last checkpoint
  std::uint32_t past = 0;       // landmarks that were loaded
  bool found = false;           // the robot found itself in them
  Time last;                    // checkpoint of this run
};

class MapKeeper {
 public:
  // A map of so many landmarks (250 m2) in which nothing of the stored one was found.
  static constexpr std::size_t kNewMap = 1000;
  // A checkpoint without new landmarks, only with better known ones, waits so many intervals:
  // flash wears with every writing.
  static constexpr int kRefinementWaits = 12;

  // `folder` must outlive it. `head` is what new maps get.
  MapKeeper(storage::Folder& folder, const storage::MapHead& head, Duration interval);

  // Before any thread; logs what was found. Empty when nothing is stored. Valid as long as this is.
  std::span<const LandmarkRecord> load();

  // --- the cooperation thread
  void note(const LandmarkRecord& own);

  // --- the keeper's own thread
  // Writes when it is time. `past` is the alignment with the stored map, or null.
  void turn_once(Time now, const PeerReport* past);
  // At the end, when all other threads are: what is not written yet.
  void finish(Time now, const PeerReport* past);

  // --- any thread
  bool read(MapStatus& out) const { return status_.read(out); }

 private:
  bool due(Time now);
  void save(Time now, const PeerReport* past);
  void leave_past(Time now);
  std::vector<LandmarkRecord> to_write(const PeerReport* past) const;

  storage::MapStore store_;
  storage::StoredMap map_;  // head of what is written; landmarks of the last checkpoint
  const Duration interval_;
  std::vector<LandmarkRecord> past_;

  std::mutex mutex_;
  storage::OwnMap own_;  // under mutex_

  std::vector<LandmarkRecord> now_;  // a copy of own_
  std::uint64_t changed_ = 0;        // of own_, at the last checkpoint
  std::uint64_t members_ = 0;
  std::uint64_t changed_now_ = 0;
  std::uint64_t members_now_ = 0;
  Time next_;
  Time next_refinement_;
  MapStatus told_;
  Snapshot<MapStatus> status_;
};

// The alignment with the stored map, when it is merged; else null. Valid as long as `report` is.
const PeerReport* past_self(const PerceptionReport& report);

// The folder of map.folder; empty: none is kept. A relative one lies in STATE_DIRECTORY.
std::string map_folder(const std::string& configured);

}  // namespace zenith
