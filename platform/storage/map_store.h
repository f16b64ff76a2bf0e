#pragma once
// Two generations of a robot's map in a folder, of which one is whole at every moment:
//
//   write map.partial -> sync it -> rename it over the older generation -> sync the folder
//
// A power cut at any point leaves the newest complete checkpoint, or the one before it. What cannot
// be read is set aside under another name and told of, never deleted and never fatal. One thread.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/folder.h"
#include "platform/storage/map_file.h"

namespace zenith::storage {

// The older one is the next to be replaced.
inline constexpr std::array<const char*, 2> kGenerations = {"map-0.zenmap", "map-1.zenmap"};
inline constexpr const char* kPartial = "map.partial";

struct LoadedMap {
  std::optional<StoredMap> map;       // the newest that can be read
  std::string file;                   // its path
  std::vector<std::string> messages;  // what was wrong, and what was done about it
};

class MapStore {
 public:
  // `folder` must outlive it.
  explicit MapStore(Folder& folder) : folder_(folder) {}

  // To be called once, before save().
  LoadedMap load();
  // Writes one checkpoint; `map.head.checkpoint` is set to the next one. After an error the
  // generations are as they were.
  Status save(StoredMap& map);

  // The place is another one: both generations get names of their own, and a new map begins.
  Status set_all_aside();

  std::size_t bytes_written() const { return bytes_written_; }  // by save(), in all

 private:
  Status rename_aside(std::size_t generation, const std::string& kind, std::string& to);
  Status set_aside(std::size_t generation, MapFault fault, std::string& to);
  Status write_partial(Bytes bytes);

  Folder& folder_;
  std::array<MapFault, kGenerations.size()> unreadable_ = {};  // and still in its place
  std::size_t newest_ = 1;                                     // the first goes to map-0
  std::uint64_t checkpoint_ = 0;
  std::size_t bytes_written_ = 0;
};

}  // namespace zenith::storage
