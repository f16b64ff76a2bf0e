#pragma once
// What of a payload is about getting to know each other: its HELLO, CHALLENGE, RESPONSE and BYE
// (docs/protocol.md, "Payload"). Pure.

#include <optional>

#include "platform/base/fixed_text.h"
#include "platform/link/sealing.h"
#include "slam/exchange/messages.h"

namespace zenith {

using RobotName = FixedText<exchange::kMaxName>;

struct Greetings {
  std::optional<RobotName> name;
  std::optional<exchange::Challenge> challenge;
  std::optional<exchange::Challenge> response;
  bool bye = false;
};

// Of several of a kind the last counts. False when the payload is malformed: a section does not
// fit, one of these has a wrong form, or the name is not that of `robot`.
bool read_greetings(exchange::Bytes payload, std::uint64_t robot, Greetings& out);

}  // namespace zenith
