#pragma once
// A stored map in bytes (docs/file-formats.md, "Stored maps"): a head, blocks of landmarks, an end.
// Landmarks are written as on the wire (slam/exchange/record_code.h): millimetres, eight-bit
// deviations, compact looks. All numbers little-endian. No file is touched here.
//
// Any bytes may be decoded: what is taken from the heap is bounded by kMaxMapBytes.

#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/bytes.h"
#include "platform/base/fixed_text.h"
#include "platform/base/result.h"
#include "slam/capacity.h"
#include "slam/fleet/record.h"

namespace zenith::storage {

inline constexpr std::uint16_t kMapVersion = 1;
inline constexpr std::size_t kMaxStoredLandmarks = kMaxLandmarks;
inline constexpr std::size_t kMaxMapBytes = std::size_t{1} << 20u;

struct MapHead {
  std::uint64_t map = 0;         // random, drawn when the map was begun; kept by all checkpoints
  std::uint64_t checkpoint = 0;  // rises with each writing: the higher one is the newer one
  std::int64_t saved_s = 0;      // wall clock, seconds since 1970, for people; 0: not known
  FixedText<32> robot;           // who wrote it
  // What looks and heights depend on: another camera's map may not be recognised.
  double camera_height_m = 0.0;
  double rectified_fov_deg = 0.0;
};

// In the map's own frame: the start frame of the first run that wrote it, metres, z up.
struct StoredMap {
  MapHead head;
  std::vector<LandmarkRecord> landmarks;  // none of them removed; revisions are not kept
};

enum class MapFault : std::uint8_t {
  kNone,
  kForeign,  // no map, or one of another version or other looks
  kDamaged,  // cut short, or a checksum differs
};

struct DecodedMap {
  MapFault fault = MapFault::kNone;
  std::string reason;  // of a fault: what was expected and found
  StoredMap map;       // empty with a fault
};

// At most kMaxStoredLandmarks, the first ones; what cannot be told (encode_record()) is left out.
std::vector<std::uint8_t> encode_map(const StoredMap& map);
DecodedMap decode_map(Bytes bytes);

}  // namespace zenith::storage
