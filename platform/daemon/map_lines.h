#pragma once
// The maps as telemetry tells them: own landmarks and peers', each as it was last heard. A reader
// gets all of them when it comes, then what changes, and all once more when a line was dropped.
//
// For the housekeeping thread: takes memory from the heap, bounded by kMostLandmarks.

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/daemon/exchange.h"
#include "platform/daemon/json_line.h"

namespace zenith {

class MapLines {
 public:
  // As many as the core keeps; further ones are not shown.
  static constexpr std::size_t kMostLandmarks = std::size_t{kMaxLandmarks} + kPeerLandmarkPool;
  // Landmarks in one line, and lines in one call of tell(): 2500 landmarks a second.
  static constexpr std::size_t kLineLandmarks = 24;
  static constexpr std::size_t kLines = 5;

  void note(const MapNews& news);
  // From now on everything is to be told again.
  void tell_all();
  // Gives the next lines to `send`; `name_of` names a peer's slot.
  void tell(const std::function<const char*(int)>& name_of,
            const std::function<void(std::string_view)>& send);
  // Nobody reads: only what is known now counts for who comes later.
  void tell_nobody();

  std::size_t size() const { return landmarks_.size(); }

 private:
  using Key = std::pair<int, std::uint32_t>;  // owner, id

  void forget(int owner);

  std::map<Key, MapNews> landmarks_;
  std::set<Key> untold_;  // changed or gone
  std::vector<int> forgotten_;
};

}  // namespace zenith
