#pragma once
// The maps as telemetry tells them: own landmarks and peers', each as it was last heard, in the
// order in which they changed. Each reader goes through that order at its own pace: it gets all of
// them when it comes, and then what changes.
//
// note() and next() from two threads without deadlines: a lock is held while landmarks are copied,
// never while anything is written or sent. Takes memory from the heap, bounded by kMostLandmarks
// and kMostGone.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "slam/capacity.h"
#include "slam/fleet/record.h"

namespace zenith {

// A landmark that is new or changed, or is no more.
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

// How far a reader is. A new one has this value.
struct MapPlace {
  std::uint64_t seen = 0;    // the last change that it was sent
  std::uint64_t joined = 0;  // the last change before it came; 0: it comes now

  bool operator==(const MapPlace&) const = default;
};

struct MapBatch {
  std::vector<std::string> lines;
  MapPlace end;  // where a reader is that got them all
  // What changed since then is not known any more: the reader must begin anew.
  bool is_too_far_behind = false;
};

class MapLines {
 public:
  // As many as the core keeps; further ones are not shown.
  static constexpr std::size_t kMostLandmarks = std::size_t{kMaxLandmarks} + kPeerLandmarkPool;
  // Removed ones that readers can still be told of.
  static constexpr std::size_t kMostGone = 4096;
  // Landmarks in one line and in one batch.
  static constexpr std::size_t kLineLandmarks = 24;
  static constexpr std::size_t kBatchLandmarks = 120;

  using NameOf = std::function<const char*(int)>;  // of a peer's slot

  void note(const MapNews& news);
  // The lines that come after `from`; none when there is nothing new.
  void next(const MapPlace& from, const NameOf& name_of, MapBatch& out) const;

  std::size_t size() const;

 private:
  using Key = std::pair<int, std::uint32_t>;  // owner, id
  using Changes = std::map<std::uint64_t, MapNews>;

  void forget(int owner);
  void add_gone(const MapNews& news);
  bool copy(const MapPlace& from, MapPlace& end, std::vector<MapNews>& out) const;

  mutable std::mutex mutex_;
  Changes changes_;                         // one for each landmark, and of those gone
  std::map<Key, std::uint64_t> landmarks_;  // where in changes_
  std::map<std::uint64_t, Key> gone_;       // removed landmarks among changes_
  std::map<int, std::uint64_t> forgotten_;  // forgotten maps among changes_, by owner
  std::uint64_t last_ = 0;
  std::uint64_t oldest_known_ = 0;  // who has not seen this change missed something for good
};

}  // namespace zenith
