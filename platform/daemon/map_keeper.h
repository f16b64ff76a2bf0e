#pragma once
// Keeps the map across restarts: says when the maps in the state folder are written. Which of them,
// and what: map_shelf.h. kNewMap landmarks of a robot that has not found itself in the main map:
// this is another place; the stored map is set aside and a new one begins.
//
// On a thread of its own: a slow card may take seconds to sync. What it needs of the own map it
// copies under a lock that is held for a millisecond at most and that perception never takes.

#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "platform/base/fixed_text.h"
#include "platform/base/time.h"
#include "platform/daemon/map_shelf.h"
#include "platform/daemon/perception_report.h"
#include "platform/linux/snapshot.h"
#include "platform/storage/own_map.h"

namespace zenith {

struct MapStatus {
  bool failing = false;          // the last checkpoint could not be written
  FixedText<200> error;          // why
  FixedText<16> place;           // of the last checkpoint: kMainMap, or one of kSessionMaps
  std::uint64_t checkpoint = 0;  // its number there; before the first, that of the loaded main map
  std::uint64_t written = 0;     // checkpoints of this run
  std::uint64_t failed = 0;
  std::uint64_t bytes = 0;      // of this run
  std::uint32_t landmarks = 0;  // of the last checkpoint
  std::uint32_t past = 0;       // landmarks of the main map that was loaded
  std::uint32_t sessions = 0;   // maps of earlier sessions that were loaded
  bool found = false;           // the robot found itself in the main map
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

  // Before any thread; logs what was found. Valid as long as this is.
  std::span<const PastMap> load();

  // --- the cooperation thread
  void note(const LandmarkRecord& own);

  // --- the keeper's own thread
  // Writes when it is time. `peers`: the alignments, those with past maps among them.
  void turn_once(Time now, std::span<const PeerReport> peers);
  // At the end, when all other threads are: what is not written yet.
  void finish(Time now, std::span<const PeerReport> peers);

  // --- any thread
  bool read(MapStatus& out) const { return status_.read(out); }

 private:
  bool due(Time now, unsigned found);
  void save(Time now, std::span<const PeerReport> peers);
  void leave_main();

  MapShelf shelf_;
  const Duration interval_;
  std::vector<PastMap> past_;

  std::mutex mutex_;
  storage::OwnMap own_;  // under mutex_

  std::vector<LandmarkRecord> now_;  // a copy of own_
  std::uint64_t changed_ = 0;        // of own_, at the last checkpoint
  std::uint64_t members_ = 0;
  std::uint64_t changed_now_ = 0;
  std::uint64_t members_now_ = 0;
  unsigned found_ = 0;  // at the last checkpoint, MapShelf::found()
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
