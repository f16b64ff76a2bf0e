#pragma once
// What the exchange with other robots tells: why datagrams were rejected, events worth a line in
// the log. Plain data.

#include <array>
#include <cstddef>
#include <cstdint>

#include "platform/base/endpoint.h"
#include "platform/link/greetings.h"

namespace zenith {

enum class Rejected : std::uint8_t {
  kForeign,       // no datagram of ours
  kEcho,          // this robot's own, come back from the group
  kOtherKey,      // of a fleet with another key
  kForged,        // the tag is wrong
  kRepeated,      // seen before, or too old to know
  kUnverified,    // the sender has not answered a challenge yet
  kOtherVersion,  // a payload that this version does not read
  kMalformed,     // right tag, wrong contents
  kQuarantined,   // of a peer whose faults were too many
  kNameTaken,     // of a robot with the name of this one, or of a newer one
  kNoRoom,        // there are as many peers as fit
};
inline constexpr std::size_t kRejectedKinds = 11;

const char* rejected_name(Rejected reason);  // "forged"

struct LinkCounters {
  std::uint64_t sent = 0;  // datagrams
  std::uint64_t sent_bytes = 0;
  std::uint64_t received = 0;  // fresh ones of verified peers
  std::uint64_t received_bytes = 0;
  std::array<std::uint64_t, kRejectedKinds> rejected = {};
  std::uint64_t challenges = 0;
  std::uint64_t responses = 0;
  std::uint64_t verified = 0;
  std::uint64_t events_lost = 0;
};

enum class LinkEventKind : std::uint8_t {
  kFound,         // a peer was verified, and its name heard
  kRestarted,     // a peer is there again with a new boot
  kSilent,        // not heard for radio.forget_after_s
  kLeft,          // it said BYE
  kQuarantined,   // `value`: for so many seconds
  kOtherVersion,  // `value`: its version
  kNameConflict,  // two robots have one name
  kNoRoom,        // a verified peer that is one too many
};

struct LinkEvent {
  LinkEventKind kind = LinkEventKind::kFound;
  std::uint64_t robot = 0;
  RobotName name;  // empty when it is not known yet
  Endpoint address;
  int value = 0;
};

}  // namespace zenith
