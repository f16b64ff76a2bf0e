#pragma once
// The maps in the state folder: the main one, which the robot goes on with, and those of sessions
// (runs) that ended before the robot found itself in it. What the present run has mapped goes
//
//   into the main map                 when there was none, or the robot found itself in it: both as
//                                     one, in the main map's frame (continued_map.h)
//   into an earlier session's         when it found itself in that one alone
//   into a session's place of its own otherwise
//
// and what is in another map now leaves its place, after that one is on the disk: a power cut
// between any two changes leaves everything in some map. A map in which the robot was wrong to
// find itself is written back as it was loaded.
//
// Without a main map the largest session stands in for it until it is one. No place left: the
// smallest session gives way. One thread.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "platform/daemon/perception_report.h"
#include "platform/storage/map_store.h"

namespace zenith {

// A map that the robot may find itself in.
struct PastMap {
  int slot = kPastSlot;  // among the peers
  bool whole = false;    // else it shows no more than a run saw: asks for as much as a peer's map
  std::span<const LandmarkRecord> landmarks;  // valid until leave_main()
};

class MapShelf {
 public:
  static constexpr int kPlaces = 1 + static_cast<int>(storage::kSessionMaps.size());
  static_assert(kPlaces == kPastMaps);

  // `folder` must outlive it. `head` is what new maps get; its `map` is this run's own number.
  MapShelf(storage::Folder& folder, const storage::MapHead& head);

  // Once, before all others; logs what was found. `ours`: what is damaged may be set aside.
  std::vector<PastMap> load(bool ours);

  // In which maps the robot found itself: a bit for each place. `peers`: alignments of all slots.
  unsigned found(std::span<const PeerReport> peers) const;
  bool has_main() const { return main_ >= 0; }
  bool found_main(unsigned found) const { return has_main() && (found >> main_ & 1u) != 0; }

  // What this run has mapped, in its own start frame.
  Status save(std::span<const LandmarkRecord> own, std::span<const PeerReport> peers);
  // The place is another one: the main map is set aside, and this run's becomes the main one.
  Status leave_main();

  // Of the last save().
  const storage::StoredMap& written() const { return written_; }
  const char* written_name() const { return places_[at(target_)].store.name().c_str(); }
  std::size_t bytes_written() const;

 private:
  enum class Disk : std::uint8_t { kNothing, kAsLoaded, kWritten };  // kWritten: by this run
  struct Place {
    storage::MapStore store;
    storage::StoredMap past;  // as loaded, to be found; no landmarks: none
    Disk disk = Disk::kNothing;
    const PeerReport* found = nullptr;  // during save()
  };

  static std::size_t at(int place) { return static_cast<std::size_t>(place); }
  int slot_of(int place) const { return place == main_ ? kPastSlot : kPastSlot - place; }
  void log_loaded(const Place& place, const storage::LoadedMap& loaded, double took_ms) const;
  int largest(bool found_ones) const;
  void choose_own_place();
  std::vector<LandmarkRecord> join(std::span<const LandmarkRecord> own, int base) const;
  Status write_back(Disk now);
  Status clear_joined();

  storage::MapHead head_;
  std::vector<Place> places_;  // kPlaces: the main map's, the sessions'
  int main_ = -1;              // which stands for the main map; -1: none
  int own_ = 0;                // where this run's map goes that is in no other
  int target_ = 0;             // of the last save()
  storage::StoredMap written_;
};

}  // namespace zenith
