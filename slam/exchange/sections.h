#pragma once
// A payload is sections one after the other: type, length of the body, body.

#include <cstddef>
#include <cstdint>

#include "slam/exchange/bytes.h"

namespace zenith::exchange {

enum class SectionType : std::uint8_t {
  kHello = 1,
  kChallenge = 2,
  kResponse = 3,
  kState = 4,
  kRecords = 5,
  kRequest = 6,
  kBye = 7,
};

inline constexpr std::size_t kMaxPayload = 1152;  // bytes, before encryption
inline constexpr std::size_t kFrameBytes = 48;    // header and tag around the payload
inline constexpr std::size_t kSectionHeader = 3;
inline constexpr std::size_t kIpv4UdpBytes = 28;  // headers below, that count for the budget
inline constexpr std::size_t kIpv6UdpBytes = 48;

struct Section {
  std::uint8_t type = 0;  // may be unknown
  Bytes body;             // inside the payload

  bool is(SectionType known) const { return type == static_cast<std::uint8_t>(known); }
};

// `while (sections.next(section))`, then malformed().
class SectionReader {
 public:
  explicit SectionReader(Bytes payload) : in_(payload) {}

  bool next(Section& section) {
    if (in_.left() == 0) return false;
    section.type = in_.u8();
    section.body = in_.take(in_.u16());
    return !in_.failed();
  }
  // A section was cut.
  bool malformed() const { return in_.failed(); }

 private:
  ByteReader in_;
};

// Begins a section in `out`; end_section() fills in its length. When the writer has failed since,
// the section is taken back whole and false returned.
inline std::size_t begin_section(ByteWriter& out, SectionType type) {
  const std::size_t start = out.size();
  out.u8(static_cast<std::uint8_t>(type));
  out.u16(0);
  return start;
}
inline bool end_section(ByteWriter& out, std::size_t start) {
  if (out.failed()) {
    out.shrink_to(start);
    return false;
  }
  out.overwrite_u16(start + 1, static_cast<std::uint16_t>(out.size() - start - kSectionHeader));
  return true;
}

}  // namespace zenith::exchange
