// Any bytes as a stored map: bounded, never fatal, and what decodes is written again the same. Also
// with right checksums, which no fuzzer finds by itself: the last byte says whether they are
// mended.

#include <cstdint>
#include <vector>

#include "platform/storage/checksum.h"
#include "platform/storage/map_file.h"
#include "slam/bounds.h"
#include "tests/fuzz/require.h"

using namespace zenith;           // NOLINT(google-build-using-namespace)
using namespace zenith::storage;  // NOLINT(google-build-using-namespace)

namespace {

constexpr std::size_t kHeadBytes = 97;

void put_u32(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

void mend(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < kHeadBytes + 16) return;
  put_u32(bytes, kHeadBytes, crc32(Bytes(bytes).first(kHeadBytes)));
  std::size_t at = kHeadBytes + 4;
  const std::size_t end = bytes.size() - 12;
  while (at + 8 <= end) {  // blocks
    const std::size_t length = ByteReader(Bytes(bytes).subspan(at + 4)).u32();
    if (length > end - at || at + 8 + length + 4 > end) break;
    put_u32(bytes, at + 8 + length, crc32(Bytes(bytes).subspan(at, 8 + length)));
    at += 8 + length + 4;
  }
  put_u32(bytes, end + 4, static_cast<std::uint32_t>(bytes.size()));
  put_u32(bytes, end + 8, crc32(Bytes(bytes).first(end)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  if (!bytes.empty() && bytes.back() == 'm') {
    bytes.pop_back();
    mend(bytes);
  }
  const DecodedMap decoded = decode_map(bytes);
  require((decoded.fault == MapFault::kNone) == decoded.reason.empty());
  if (decoded.fault != MapFault::kNone) {
    require(decoded.map.landmarks.empty());
    return 0;
  }
  require(decoded.map.landmarks.size() <= kMaxStoredLandmarks);
  for (const LandmarkRecord& r : decoded.map.landmarks) {
    for (const float p : {r.x_m, r.y_m, r.z_m}) require(is_within(p, kFarthest_m));
    require(is_covariance(r.covariance_m2));
    require(r.appearance_count <= kPublishedAppearances);
  }
  const auto again = encode_map(decoded.map);
  const DecodedMap twice = decode_map(again);
  require(twice.fault == MapFault::kNone);
  require(twice.map.landmarks.size() == decoded.map.landmarks.size());
  require(encode_map(twice.map) == again);
  return 0;
}
