#pragma once
// What the cooperation thread tells of other robots. Plain data.

#include <array>
#include <cstdint>

#include "drivers/radio/udp_radio.h"
#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"
#include "platform/daemon/perception_report.h"
#include "platform/link/link_report.h"
#include "slam/capacity.h"
#include "slam/exchange/interface.h"
#include "slam/geometry.h"

namespace zenith {

// A verified robot that is not silent.
struct LinkPeer {
  RobotName name;  // empty until it was heard
  std::uint64_t robot = 0;
  Endpoint address;
  Time heard;
  int slot = -1;          // of its map, as perception knows it; -1: no room for it
  bool complete = false;  // all that it told of is here
  std::uint32_t landmarks = 0;
  bool quarantined = false;
  bool has_pose = false;  // it told
  Pose2 T_start_robot;    // in its own start frame
};

struct LinkStatus {
  bool enabled = false;  // there is a key
  bool open = false;     // there are sockets
  RadioCounters radio;
  LinkCounters link;
  exchange::Counters exchange;
  FixedVector<LinkPeer, kMaxSessions> peers;
  // Whose maps lie in perception's slots; of silent robots, too.
  std::array<RobotName, kMaxPeers> names;

  // "?" when it is not known.
  const char* name_of(int slot) const {
    if (slot == kPastSlot) return "past self";
    if (slot >= kPeerSlots) return "earlier session";
    const bool known =
        slot >= 0 && slot < kMaxPeers && !names[static_cast<std::size_t>(slot)].empty();
    return known ? names[static_cast<std::size_t>(slot)].c_str() : "?";
  }
};

}  // namespace zenith
