#pragma once
// The bodies of all sections but RECORDS (docs/protocol.md, "Payload"), plain data.
//
// append() writes a whole section and returns false, having written nothing, when it does not fit.
// decode() reads a body and returns false when it is malformed; `out` is then of no use.

#include <array>
#include <cstdint>
#include <string_view>

#include "platform/base/fixed_vector.h"
#include "platform/base/printable.h"
#include "slam/exchange/sections.h"
#include "slam/geometry.h"

namespace zenith::exchange {

inline constexpr std::size_t kMaxName = kMaxRobotName;
inline constexpr std::size_t kMaxAlignmentsTold = 8;
inline constexpr std::size_t kMaxRangesAsked = 16;
inline constexpr std::uint32_t kToHead = 0xFFFFFFFFU;

struct Hello {
  FixedVector<char, kMaxName> name;  // is_robot_name()

  std::string_view text() const { return {name.begin(), name.size()}; }
};

// CHALLENGE and RESPONSE.
struct Challenge {
  std::uint64_t robot = 0;  // of whom it is for
  std::uint64_t boot = 0;
  std::array<std::uint8_t, 16> nonce = {};
};

enum class Health : std::uint8_t { kStarting, kMapping, kMerged, kDegraded, kFault };

// How one robot aligns a peer's map with its own.
struct AlignmentNotice {
  enum class State : std::uint8_t { kCandidate, kMerged, kWithdrawn };

  std::uint64_t robot = 0;
  std::uint32_t map = 0;
  State state = State::kCandidate;
  Pose2 T_own_peer;                       // takes the peer's coordinates into the sender's
  std::array<double, 3> deviations = {};  // x, y in metres, angle in radians
  std::uint16_t correspondences = 0;
  double confidence = 0.0;  // 0 to 1
};

struct StateNotice {
  std::uint32_t map = 0;
  std::uint32_t head = 0;
  std::uint32_t present = 0;
  std::uint64_t checksum = 0;
  Pose2 T_start_robot;
  Health health = Health::kStarting;
  FixedVector<AlignmentNotice, kMaxAlignmentsTold> alignments;
};

// Revisions first .. last, both included.
struct Range {
  std::uint32_t first = 1;
  std::uint32_t last = 0;

  friend bool operator==(const Range&, const Range&) = default;
};

struct Request {
  std::uint64_t robot = 0;  // the owner
  std::uint32_t map = 0;
  FixedVector<Range, kMaxRangesAsked> ranges;
};

bool append(ByteWriter& out, const Hello& hello);
bool append(ByteWriter& out, SectionType challenge_or_response, const Challenge& challenge);
bool append(ByteWriter& out, const StateNotice& state);
bool append(ByteWriter& out, const Request& request);
bool append_bye(ByteWriter& out);

bool decode(Bytes body, Hello& out);
bool decode(Bytes body, Challenge& out);
bool decode(Bytes body, StateNotice& out);
bool decode(Bytes body, Request& out);

// Bytes that they take as sections.
inline constexpr std::size_t kStateBytes = kSectionHeader + 32;
inline constexpr std::size_t kAlignmentBytes = 30;
inline constexpr std::size_t kRequestBytes = kSectionHeader + 13;
inline constexpr std::size_t kRangeBytes = 8;

}  // namespace zenith::exchange
