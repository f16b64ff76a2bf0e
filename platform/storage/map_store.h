#pragma once
// Two generations of a map in a folder, of which one is whole at every moment:
//
//   write NAME.partial -> sync it -> rename it over the older generation -> sync the folder
//
// A power cut at any point leaves the newest complete checkpoint, or the one before it. What cannot
// be read is set aside under another name and told of, never deleted and never fatal. One thread.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/storage/folder.h"
#include "platform/storage/map_file.h"

namespace zenith::storage {

inline constexpr std::size_t kGenerations = 2;  // the older one is the next to be replaced
// The map that the robot goes on with.
inline constexpr const char* kMainMap = "map";
// Of runs that ended before the robot found itself in it.
inline constexpr std::array<const char*, 4> kSessionMaps = {"session-1", "session-2", "session-3",
                                                            "session-4"};

inline std::string generation_file(const std::string& name, std::size_t generation) {
  return name + "-" + std::to_string(generation) + ".zenmap";
}

struct LoadedMap {
  std::optional<StoredMap> map;       // the newest that can be read
  std::string file;                   // its path
  std::vector<std::string> messages;  // what was wrong, and what was done about it
};

class MapStore {
 public:
  // `folder` must outlive it; several maps in one have different names.
  explicit MapStore(Folder& folder, std::string name = kMainMap)
      : folder_(folder), name_(std::move(name)) {}

  enum class Damaged {
    kSetAside,  // at once
    kLeave,     // in its place until save() needs it: the folder is not this program's to change
  };
  // To be called once, before save().
  LoadedMap load(Damaged damaged = Damaged::kSetAside);
  // Writes one checkpoint; `map.head.checkpoint` is set to the next one. After an error the newest
  // generation that was reported as written is still there, and the next save() leaves it alone.
  Status save(StoredMap& map);

  // The place is another one: both generations get names of their own, and a new map begins.
  Status set_all_aside();
  // Both generations go for good: what they hold is in another map that is on the disk.
  Status remove();

  const std::string& name() const { return name_; }
  std::size_t bytes_written() const { return bytes_written_; }  // by save(), in all

 private:
  std::string file(std::size_t generation) const { return generation_file(name_, generation); }
  std::string partial() const { return name_ + ".partial"; }
  Status rename_aside(std::size_t generation, const std::string& kind, std::string& to);
  Status set_aside(std::size_t generation, MapFault fault, std::string& to);
  Status write_partial(Bytes bytes);

  Folder& folder_;
  const std::string name_;
  std::array<MapFault, kGenerations> unreadable_ = {};  // and still in its place
  std::size_t newest_ = 1;                              // the first goes to NAME-0
  std::uint64_t checkpoint_ = 0;
  std::size_t bytes_written_ = 0;
};

}  // namespace zenith::storage
