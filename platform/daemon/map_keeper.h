#pragma once
// Keeps the map across restarts: says when the maps in the state folder are written. Which of them,
// and what: map_shelf.h. kNewMap landmarks of a robot that has not found itself in the main map:
// this is another place; the stored map is set aside and a new one begins.
//
// The folder has one user (folder_lock.h). As long as that is another program the map is not kept,
// which the status says; once it is free, this run's map goes beside what lies there, as one of a
// run that ended before the robot found itself. Each turn asks whether it still is this program's:
// a run that lost it to another program keeps its map no more, for it knows other files than lie
// there.
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
  bool left = false;            // the main map that was loaded was abandoned in this run
  Time last;                    // checkpoint of this run
};

class MapKeeper {
 public:
  // A map of so many landmarks (250 m2) in which nothing of the stored one was found.
  static constexpr std::size_t kNewMap = 1000;
  // A checkpoint without new landmarks, only with better known ones, waits so many intervals:
  // flash wears with every writing.
  static constexpr int kRefinementWaits = 12;

  // How often the folder is asked for, as long as another program has it.
  static constexpr Duration kLockRetry = {1'000'000'000};

  // `folder` must outlive it. `head` is what new maps get; its robot is who others hear has the
  // folder.
  MapKeeper(storage::Folder& folder, const storage::MapHead& head, Duration interval);

  // Before any thread; logs what was found. Valid as long as this is. Nothing when another program
  // has the folder: that one may write at any moment.
  std::span<const PastMap> load();

  // --- the cooperation thread
  void note(const LandmarkRecord& own);

  // --- the keeper's own thread
  // Writes when it is time. `peers`: the alignments, those with past maps among them.
  void turn_once(Time now, std::span<const PeerReport> peers);
  // Whether the main map that was loaded was abandoned: nothing is to be told in its frame.
  bool left_main() const { return told_.left; }
  // At the end, when all other threads are: what is not written yet.
  void finish(Time now, std::span<const PeerReport> peers);

  // --- any thread
  bool read(MapStatus& out) const { return status_.read(out); }

 private:
  bool take_folder(Time now);
  void note_failure(const std::string& why);
  bool due(Time now, unsigned found);
  void save(Time now, std::span<const PeerReport> peers);
  void leave_main();

  storage::Folder& folder_;
  const storage::FolderUser self_;
  MapShelf shelf_;
  bool ours_ = false;        // the folder
  bool loaded_ = false;      // the shelf
  bool looked_for_ = false;  // the robot looks for itself in what was loaded
  Time next_try_;            // to have the folder
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
  std::string told_why_;  // the whole of told_.error
  Snapshot<MapStatus> status_;
};

// The alignment with the stored map, when it is merged; else null. Valid as long as `report` is.
const PeerReport* past_self(const PerceptionReport& report);
// What the report says of a stored map that was abandoned is taken out. `status`: read after it.
void keep_what_counts(PerceptionReport& report, const MapStatus& status);

// STATE_DIRECTORY; empty: there is none.
std::string state_folder();
// The folder of map.folder; empty: none is kept. A relative one lies in the folder `state`.
std::string map_folder(const std::string& configured, const std::string& state);
// Makes what is missing of a relative map.folder in `state`. Others are made by who mounts disks.
Status make_map_folder(const std::string& configured, const std::string& state);

}  // namespace zenith
