#include "slam/exchange/records_section.h"

namespace zenith::exchange {
namespace {

constexpr std::size_t kLastAt = kSectionHeader + 8;
constexpr std::size_t kCountAt = kSectionHeader + 12;

bool well_formed_records(Bytes body) {
  RecordsReader records(body);
  LandmarkRecord record;
  while (records.next(record)) {
  }
  return !records.malformed();
}

template <typename Message>
bool decodes(Bytes body) {
  Message message;
  return decode(body, message);
}

bool well_formed_section(const Section& section) {
  switch (static_cast<SectionType>(section.type)) {
    case SectionType::kHello:
      return decodes<Hello>(section.body);
    case SectionType::kChallenge:
    case SectionType::kResponse:
      return decodes<Challenge>(section.body);
    case SectionType::kState:
      return decodes<StateNotice>(section.body);
    case SectionType::kRecords:
      return well_formed_records(section.body);
    case SectionType::kRequest:
      return decodes<Request>(section.body);
    case SectionType::kBye:
      return section.body.empty();
  }
  return true;
}

}  // namespace

RecordsReader::RecordsReader(Bytes body) : in_(body) {
  header_.map = in_.u32();
  header_.range.first = in_.u32();
  header_.range.last = in_.u32();
  header_.count = in_.u8();
  left_ = header_.count;
  malformed_ = in_.failed() || header_.range.first == 0 ||
               header_.range.last < header_.range.first || header_.range.last == kToHead;
}

bool RecordsReader::next(LandmarkRecord& record) {
  if (malformed_) return false;
  if (left_ == 0) {
    malformed_ = !in_.done();
    return false;
  }
  --left_;
  malformed_ = !decode_record(in_, header_.range.first, record) ||
               record.revision > header_.range.last || record.revision <= last_revision_;
  last_revision_ = record.revision;
  return !malformed_;
}

RecordsWriter::RecordsWriter(ByteWriter& out, std::uint32_t map, std::uint32_t first)
    : out_(out), start_(out.size()), first_(first) {
  if (out.left() < kRecordsHeader) return;
  opened_ = true;
  begin_section(out, SectionType::kRecords);
  out.u32(map);
  out.u32(first);
  out.u32(0);
  out.u8(0);
}

bool RecordsWriter::add(const EncodedRecord& record, std::uint32_t revision) {
  if (!opened_ || count_ == kMaxRecordsInSection || record.size > out_.left()) return false;
  if (revision - first_ > 0xFFFFU) return false;
  append_record(out_, record, static_cast<std::uint16_t>(revision - first_));
  ++count_;
  return true;
}

bool RecordsWriter::finish(std::uint32_t last) {
  if (!opened_) return false;
  out_.overwrite_u32(start_ + kLastAt, last);
  out_.overwrite_u8(start_ + kCountAt, static_cast<std::uint8_t>(count_));
  return end_section(out_, start_);
}

bool well_formed(Bytes payload) {
  SectionReader sections(payload);
  Section section;
  while (sections.next(section)) {
    if (!well_formed_section(section)) return false;
  }
  return !sections.malformed();
}

}  // namespace zenith::exchange
