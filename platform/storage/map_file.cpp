#include "platform/storage/map_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "platform/base/printable.h"
#include "platform/storage/checksum.h"
#include "slam/exchange/record_code.h"

namespace zenith::storage {
namespace {

// The first byte is no text and the last two find out whoever "corrects" line ends.
constexpr std::array<std::uint8_t, 8> kMagic = {0xB7, 'Z', 'E', 'N', 'M', 'A', '\r', '\n'};
constexpr std::uint32_t kEnd = 0x444E455Au;  // "ZEND"
constexpr std::size_t kHeadBytes = 8 + 2 + 2 + 4 + 3 * 8 + 2 * 8 + 2 + 2 + 4 + 1 + 32;
constexpr std::size_t kEndBytes = 12;
constexpr std::size_t kBlockLandmarks = 64;
constexpr std::size_t kBlockHeadBytes = 8;
constexpr std::size_t kRobotBytes = kMaxRobotName;

static_assert(kHeadBytes + 4 + kEndBytes +
                      (kMaxStoredLandmarks / kBlockLandmarks + 1) * (kBlockHeadBytes + 4) +
                      kMaxStoredLandmarks * exchange::kMaxRecordBytes <=
                  kMaxMapBytes,
              "a full map is a file that is read again");

void write_head(ByteWriter& out, const MapHead& head, std::uint32_t count) {
  out.bytes(kMagic).u16(kMapVersion).u16(static_cast<std::uint16_t>(kHeadBytes)).u32(count);
  out.u64(head.map).u64(head.checkpoint).i64(head.saved_s);
  out.f64(head.camera_height_m).f64(head.rectified_fov_deg);
  out.u16(kPatchSize).u16(kCompactLength).u32(kRectifiedSize);
  std::array<std::uint8_t, kRobotBytes> name = {};
  const std::string_view robot = head.robot.view();
  std::copy(robot.begin(), robot.end(), name.begin());
  out.u8(static_cast<std::uint8_t>(robot.size())).bytes(name);
  out.u32(crc32(out.written()));
}

void write_block(ByteWriter& out, std::span<const exchange::EncodedRecord> records) {
  const std::size_t start = out.size();
  out.u16(static_cast<std::uint16_t>(records.size())).u16(0).u32(0);
  for (const exchange::EncodedRecord& record : records) exchange::append_record(out, record, 0);
  const std::size_t body = out.size() - start - kBlockHeadBytes;
  out.overwrite_u32(start + 4, static_cast<std::uint32_t>(body));
  out.u32(crc32(out.written().subspan(start)));
}

DecodedMap fault(MapFault kind, std::string reason) {
  DecodedMap out;
  out.fault = kind;
  out.reason = std::move(reason);
  return out;
}

DecodedMap damaged(const char* where) {
  return fault(MapFault::kDamaged, std::string("the map is damaged: ") + where);
}

// The reason, or empty when the head is good.
std::string read_head(ByteReader& in, MapHead& head, std::uint32_t& count) {
  count = in.u32();
  head.map = in.u64();
  head.checkpoint = in.u64();
  head.saved_s = in.i64();
  head.camera_height_m = in.f64();
  head.rectified_fov_deg = in.f64();
  const unsigned patch = in.u16();
  const unsigned compact = in.u16();
  const std::uint32_t rectified = in.u32();
  const std::size_t length = in.u8();
  const Bytes name = in.take(kRobotBytes);
  if (in.failed() || length > kRobotBytes || count > kMaxStoredLandmarks ||
      !std::isfinite(head.camera_height_m) || !std::isfinite(head.rectified_fov_deg)) {
    return "its head says what cannot be";
  }
  if (patch != kPatchSize || compact != kCompactLength || rectified != kRectifiedSize) {
    return "its landmarks' looks are of another kind: expected patches of " +
           std::to_string(kPatchSize) + " pixels with " + std::to_string(kCompactLength) +
           " coefficients, found " + std::to_string(patch) + " with " + std::to_string(compact);
  }
  head.robot.assign({reinterpret_cast<const char*>(name.data()), length});
  // Empty: nobody said it.
  if (length > 0 && !is_robot_name(head.robot.view())) return "its robot's name is no name";
  return {};
}

bool read_block(ByteReader& in, std::vector<LandmarkRecord>& out) {
  ByteReader begin = in;
  const std::size_t count = begin.u16();
  const bool plain = begin.u16() == 0;
  const std::size_t bytes = begin.u32();
  if (begin.failed() || !plain || count == 0 || count > kBlockLandmarks) return false;
  if (bytes > count * exchange::kMaxRecordBytes) return false;
  const Bytes block = in.take(kBlockHeadBytes + bytes);
  const std::uint32_t checksum = in.u32();
  if (in.failed() || checksum != crc32(block)) return false;
  ByteReader records(block.subspan(kBlockHeadBytes));
  for (std::size_t i = 0; i < count; ++i) {
    LandmarkRecord record;
    if (!exchange::decode_record(records, 1, record) || record.removed) return false;
    out.push_back(record);
  }
  return records.done();
}

}  // namespace

std::vector<std::uint8_t> encode_map(const StoredMap& map) {
  std::vector<exchange::EncodedRecord> records;
  records.reserve(std::min(map.landmarks.size(), kMaxStoredLandmarks));
  for (const LandmarkRecord& landmark : map.landmarks) {
    if (records.size() == kMaxStoredLandmarks) break;
    exchange::EncodedRecord encoded;
    if (!landmark.removed && exchange::encode_record(landmark, encoded)) records.push_back(encoded);
  }
  std::vector<std::uint8_t> bytes(kMaxMapBytes);
  ByteWriter out(bytes);
  write_head(out, map.head, static_cast<std::uint32_t>(records.size()));
  const std::span<const exchange::EncodedRecord> all = records;
  for (std::size_t at = 0; at < all.size(); at += kBlockLandmarks) {
    write_block(out, all.subspan(at, std::min(kBlockLandmarks, all.size() - at)));
  }
  const std::uint32_t whole = crc32(out.written());
  out.u32(kEnd).u32(static_cast<std::uint32_t>(out.size() + 8)).u32(whole);
  bytes.resize(out.size());
  return bytes;
}

DecodedMap decode_map(Bytes bytes) {
  if (bytes.size() > kMaxMapBytes) return fault(MapFault::kForeign, "it is too long for a map");
  if (bytes.size() < kMagic.size()) return damaged("it is shorter than a head");
  if (!std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    return fault(MapFault::kForeign, "it does not begin as a map does");
  }
  ByteReader in(bytes.subspan(kMagic.size()));
  const unsigned version = in.u16();
  const unsigned head_bytes = in.u16();
  if (!in.failed() && version != kMapVersion) {
    return fault(MapFault::kForeign, "expected version " + std::to_string(kMapVersion) +
                                         " of the format, found " + std::to_string(version));
  }
  if (head_bytes != kHeadBytes || bytes.size() < kHeadBytes + 4 + kEndBytes) {
    return damaged("it is cut short");
  }
  ByteReader checksum(bytes.subspan(kHeadBytes));
  if (checksum.u32() != crc32(bytes.first(kHeadBytes))) return damaged("its head's checksum");
  ByteReader end(bytes.last(kEndBytes));
  if (end.u32() != kEnd || end.u32() != bytes.size()) return damaged("its end is missing");
  if (end.u32() != crc32(bytes.first(bytes.size() - kEndBytes))) return damaged("its checksum");

  DecodedMap out;
  std::uint32_t count = 0;
  const std::string reason = read_head(in, out.map.head, count);
  if (!reason.empty()) return fault(MapFault::kForeign, reason);
  ByteReader blocks(bytes.subspan(kHeadBytes + 4, bytes.size() - kHeadBytes - 4 - kEndBytes));
  out.map.landmarks.reserve(count);
  while (blocks.left() > 0) {
    if (!read_block(blocks, out.map.landmarks)) return damaged("a block of landmarks");
  }
  if (out.map.landmarks.size() != count) return damaged("landmarks are missing");
  return out;
}

}  // namespace zenith::storage
