#pragma once
// What the kernel knows of a CAN interface: from /sys/class/net, and bitrate, state and error
// counters by a netlink message, which is all that /sys lacks.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "tools/doctor/machine_files.h"

namespace zenith::tools {

struct CanController {
  std::string kind;                    // "can", "vcan", "vxcan"
  std::optional<std::uint32_t> state;  // enum can_state of linux/can/netlink.h
  std::optional<std::uint32_t> bitrate;
  std::optional<std::uint32_t> restart_ms;  // 0: not by itself
  std::uint32_t transmit_errors = 0;
  std::uint32_t receive_errors = 0;
};

struct CanLink {
  bool exists = false;
  bool is_can = false;
  bool up = false;
  CanController controller;
  std::uint64_t received = 0;  // frames, since the interface was made
  std::uint64_t receive_errors = 0;
  std::uint64_t receive_dropped = 0;
};

CanLink read_can_link(const MachineFiles& files, const std::string& interface);

// Of the netlink answer to RTM_GETLINK; what is not in it stays unset.
CanController parse_can_controller(std::span<const std::uint8_t> answer);
// Asks the kernel for that answer; empty when it gives none.
std::string ask_can_controller(const std::string& interface);

}  // namespace zenith::tools
