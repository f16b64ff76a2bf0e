// Any payload: what decodes is written back with the same bytes, but for what is rounded.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slam/exchange/records_section.h"
#include "tests/fuzz/require.h"

using namespace zenith;            // NOLINT(google-build-using-namespace)
using namespace zenith::exchange;  // NOLINT(google-build-using-namespace)

namespace {

template <typename Message, typename Append>
bool comes_back(Bytes body, const Append& append_to) {
  Message message;
  if (!decode(body, message)) return false;
  std::vector<std::uint8_t> room(70000);
  ByteWriter out(room);
  require(append_to(out, message));
  const Bytes written = out.written().subspan(kSectionHeader);
  require(std::equal(written.begin(), written.end(), body.begin(), body.end()));
  return true;
}

bool decodes(const Section& section) {
  const auto plain = [](ByteWriter& out, const auto& message) { return append(out, message); };
  const auto challenge = [](ByteWriter& out, const Challenge& c) {
    return append(out, SectionType::kChallenge, c);
  };
  switch (static_cast<SectionType>(section.type)) {
    case SectionType::kHello:
      return comes_back<Hello>(section.body, plain);
    case SectionType::kChallenge:
    case SectionType::kResponse:
      return comes_back<Challenge>(section.body, challenge);
    case SectionType::kState:
      return comes_back<StateNotice>(section.body, plain);
    case SectionType::kRequest:
      return comes_back<Request>(section.body, plain);
    case SectionType::kRecords: {
      RecordsReader records(section.body);
      LandmarkRecord record;
      std::uint32_t last = 0;
      std::size_t count = 0;
      while (records.next(record)) {
        require(record.revision > last && record.revision >= records.header().range.first);
        require(record.revision <= records.header().range.last);
        last = record.revision;
        ++count;
      }
      if (!records.malformed()) require(count == records.header().count);
      return !records.malformed();
    }
    case SectionType::kBye:
      return section.body.empty();
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes payload(data, size);
  SectionReader sections(payload);
  Section section;
  bool all = true;
  std::size_t bytes = 0;
  while (sections.next(section)) {
    bytes += kSectionHeader + section.body.size();
    all = decodes(section) && all;
  }
  require(sections.malformed() || bytes == size);
  require(well_formed(payload) == (all && !sections.malformed()));
  return 0;
}
