#pragma once
// RECORDS: all records whose revision lies in first .. last; others of these revisions are
// superseded.

#include "slam/exchange/messages.h"
#include "slam/exchange/record_code.h"

namespace zenith::exchange {

struct RecordsHeader {
  std::uint32_t map = 0;
  Range range;
  std::uint8_t count = 0;
};
inline constexpr std::size_t kRecordsHeader = kSectionHeader + 13;
inline constexpr std::size_t kMaxRecordsInSection = 255;

// Walks through a body whose form was checked before: `while (records.next(record))`.
class RecordsReader {
 public:
  explicit RecordsReader(Bytes body);

  const RecordsHeader& header() const { return header_; }
  // The next record; false behind the last one, or at the first one that is malformed.
  bool next(LandmarkRecord& record);
  // After the last next(): the body was malformed.
  bool malformed() const { return malformed_; }

 private:
  ByteReader in_;
  RecordsHeader header_;
  std::uint32_t last_revision_ = 0;
  std::size_t left_ = 0;
  bool malformed_ = false;
};

// Appends a section record by record, in rising revision.
class RecordsWriter {
 public:
  // Reserves the section's head; full at once when there is no room for it.
  RecordsWriter(ByteWriter& out, std::uint32_t map, std::uint32_t first);

  // False, and nothing written, when it does not fit.
  bool add(const EncodedRecord& record, std::uint32_t revision);
  std::size_t count() const { return count_; }
  // Writes the range's end; false when there is no room for the section.
  bool finish(std::uint32_t last);
  // Takes the section back.
  void cancel() { out_.shrink_to(start_); }

 private:
  ByteWriter& out_;
  std::size_t start_;
  std::uint32_t first_;
  std::size_t count_ = 0;
  bool opened_ = false;
};

// The form of all sections of known type: what the whole payload must have before any of it is
// used.
bool well_formed(Bytes payload);

}  // namespace zenith::exchange
