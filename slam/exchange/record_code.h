#pragma once
// A landmark's record in bytes (docs/protocol.md, "RECORDS").

#include <array>
#include <cstdint>
#include <span>

#include "slam/exchange/bytes.h"
#include "slam/exchange/quantise.h"
#include "slam/fleet/record.h"

namespace zenith::exchange {

inline constexpr std::size_t kRemovedBytes = 8;
inline constexpr std::size_t kRecordBytes = 23;
inline constexpr std::size_t kBytesOfLook = 1 + kLookBytes;
inline constexpr std::size_t kMaxRecordBytes = kRecordBytes + kPublishedAppearances * kBytesOfLook;
static_assert(kMaxRecordBytes == 170);

// One record as it goes onto the wire; the revision's two bytes are written when it is sent.
struct EncodedRecord {
  std::array<std::uint8_t, kMaxRecordBytes> data = {};
  std::uint8_t size = 0;

  Bytes bytes() const { return Bytes(data).first(size); }
};

// False, and `out` untouched, when the record cannot be told: a place or covariance that is not
// finite, lies beyond 8.3 km or is less certain than 6.2 m. More than 7 looks are cut, more than
// 255 observations told as 255. A matrix that is not positive semidefinite loses correlation.
bool encode_record(const LandmarkRecord& record, EncodedRecord& out);

// Appends; the caller has checked that there is room. `revision_less_first` is the record's
// revision less the section's first one.
void append_record(ByteWriter& out, const EncodedRecord& record, std::uint16_t revision_less_first);

// The next record; false when its bytes are malformed. A decoded record is finite, has a positive
// semidefinite covariance and the revision first + what is written.
bool decode_record(ByteReader& in, std::uint32_t first, LandmarkRecord& record);

}  // namespace zenith::exchange
