#pragma once
// The robots of a run, and what they tell each other.

#include <memory>
#include <vector>

#include "tools/runner/member.h"

namespace zenith::tools {

using Team = std::vector<std::unique_ptr<Member>>;

// The robot whose next frame is the oldest, or -1 when all are at their end.
int next_to_step(const Team& team);

enum class MapSharing {
  kNone,    // each robot alone
  kAsSent,  // records rounded as on the wire (docs/protocol.md)
  kExact,   // not rounded: to see what that costs
};

// What a robot has to tell after its step goes to all in `to`, at once: its new records, and with
// whom it has merged; the peer tests that against its own map.
void tell_peers(Team& team, int from, const std::vector<int>& to, MapSharing sharing);

}  // namespace zenith::tools
