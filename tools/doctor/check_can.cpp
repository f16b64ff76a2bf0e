#include "tools/doctor/check_can.h"

#include <linux/can/netlink.h>

#include <array>
#include <cstdio>

#include "platform/linux/clock.h"

namespace zenith::tools {
namespace {

std::string id_text(const CanId& id) {
  char text[32];
  std::snprintf(text, sizeof text, id.extended ? "0x%08X (29 bits)" : "0x%X", id.id);
  return text;
}

std::string ids_text(const std::map<CanId, std::uint64_t>& by_id) {
  constexpr std::size_t kMost = 8;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [id, count] : by_id) {
    if (++shown > kMost) return text + ", ... (" + std::to_string(by_id.size()) + " in all)";
    text += (text.empty() ? "" : ", ") + id_text(id);
  }
  return text;
}

std::string rate_text_of(double count, double seconds) {
  char text[48];
  std::snprintf(text, sizeof text, "%.0f a second", seconds > 0.0 ? count / seconds : 0.0);
  return text;
}

const char* state_name(std::uint32_t state) {
  switch (state) {
    case CAN_STATE_ERROR_ACTIVE:
      return "error-active";
    case CAN_STATE_ERROR_WARNING:
      return "error-warning";
    case CAN_STATE_ERROR_PASSIVE:
      return "error-passive";
    case CAN_STATE_BUS_OFF:
      return "bus-off";
    case CAN_STATE_STOPPED:
      return "stopped";
    case CAN_STATE_SLEEPING:
      return "sleeping";
    default:
      return "unknown";
  }
}

}  // namespace

std::vector<std::string> list_can_interfaces(const MachineFiles& files) {
  std::vector<std::string> names;
  for (const std::string& name : files.list("/sys/class/net")) {
    if (read_can_link(files, name).is_can) names.push_back(name);
  }
  return names;
}

Finding check_can_interface(const std::string& name, const CanLink& link,
                            const std::vector<std::string>& others) {
  const std::string what = "can interface";
  std::string list;
  for (const std::string& other : others) list += (list.empty() ? "" : ", ") + other;
  if (list.empty()) list = "none";
  if (!link.exists) {
    return fail(what, name + " is not there; CAN interfaces: " + list,
                "plug the adapter in, load its driver, or correct odometry.can_interface",
                "ip -brief link show type can");
  }
  if (!link.is_can) {
    return fail(what, name + " is no CAN interface; there are: " + list,
                "correct odometry.can_interface");
  }
  if (!link.up) {
    return fail(what, name + " is down", "bring it up with the base's bitrate",
                "sudo ip link set " + name + " up type can bitrate 500000 restart-ms 100");
  }
  return ok(what, name + " is up");
}

Finding check_can_controller(const std::string& name, const CanLink& link) {
  const std::string what = "can controller";
  const CanController& c = link.controller;
  if (!link.is_can || !link.up) return skip(what, name + " is not up");
  if (c.kind != "can") {
    return ok(what, (c.kind.empty() ? "none that tells" : c.kind + ": a bus without a controller"));
  }
  std::string found = state_name(c.state.value_or(CAN_STATE_MAX));
  if (c.bitrate) found += ", " + std::to_string(*c.bitrate / 1000) + " kbit/s";
  found += ", errors sending " + std::to_string(c.transmit_errors) + ", receiving " +
           std::to_string(c.receive_errors);
  const std::string again = "sudo ip link set " + name + " down && sudo ip link set " + name +
                            " up type can bitrate 500000 restart-ms 100";
  switch (c.state.value_or(CAN_STATE_ERROR_ACTIVE)) {
    case CAN_STATE_BUS_OFF:
    case CAN_STATE_STOPPED:
      return fail(what, found,
                  "the bitrate is not the bus's, or the wiring is wrong (termination, H and L "
                  "swapped); then restart it",
                  again);
    case CAN_STATE_ERROR_PASSIVE:
    case CAN_STATE_ERROR_WARNING:
      return warn(what, found, "compare the bitrate with the base's, and look at the wiring",
                  again);
    default:
      break;
  }
  if (c.restart_ms.value_or(1) == 0) {
    return warn(what, found + ", stays off after bus-off", "set restart-ms, so that it comes back",
                again);
  }
  return ok(what, found);
}

TrafficFacts listen_to(CanBus& bus, WheelDecoder decoder, Duration how_long) {
  TrafficFacts facts;
  if (const Status opened = bus.open(); !opened) {
    facts.problem = opened.error().message;
    return facts;
  }
  std::array<CanFrame, 64> frames;
  const Time begin = monotonic_now();
  double last_travel = 0.0;
  while (monotonic_now() < begin + how_long && bus.state() != CanState::kDown) {
    const std::size_t count = bus.receive({20'000'000}, frames);
    for (std::size_t i = 0; i < count; ++i) {
      ++facts.by_id[id_of(frames[i])];
      const auto sample = decoder.decode(frames[i]);
      if (!sample) continue;
      const double travel = sample->left_m + sample->right_m;
      facts.distinct_travel += travel != last_travel;
      last_travel = travel;
    }
  }
  facts.seconds = (monotonic_now() - begin).seconds();
  facts.decoder = decoder.counters();
  facts.fault = decoder.fault();
  facts.counters = bus.counters();
  bus.close();
  return facts;
}

Finding check_can_traffic(const std::string& name, const TrafficFacts& facts) {
  const std::string what = "can traffic";
  if (!facts.problem.empty()) {
    return fail(what, facts.problem, "see the line about the interface");
  }
  const CanCounters& c = facts.counters;
  if (c.frames == 0) {
    return fail(what, "nothing came on " + name + (c.error_frames > 0 ? " but errors" : ""),
                "switch the base on; compare bitrate and wiring", "candump " + name);
  }
  const std::string found = rate_text_of(static_cast<double>(c.frames), facts.seconds) +
                            ", identifiers " + ids_text(facts.by_id);
  if (c.dropped > 0) {
    return warn(what, found + ", " + std::to_string(c.dropped) + " dropped by the kernel",
                "the computer is too busy");
  }
  if (c.error_frames > 0) {
    return warn(what, found + ", " + std::to_string(c.error_frames) + " error frames",
                "look at wiring and bitrate");
  }
  return ok(what, found);
}

Finding check_wheels(const TrafficFacts& facts, const CanIds& expected, const std::string& codec) {
  const std::string what = "wheels";
  if (facts.counters.frames == 0) return skip(what, "no CAN frame came");
  std::string wanted;
  for (const CanId& id : expected) wanted += (wanted.empty() ? "" : ", ") + id_text(id);
  const WheelDecoderCounters& d = facts.decoder;
  if (d.unknown_ids == facts.counters.frames) {
    for (const CanId& id : expected) {
      const CanId other = {id.id, !id.extended};
      if (!facts.by_id.contains(other)) continue;
      return fail(what,
                  "the codec " + codec + " reads " + id_text(id) + "; what came is " +
                      id_text(other) + ", an identifier of the other length",
                  id.extended ? "configure 11 bits: in a DBC file, take 2147483648 from its number"
                              : "configure 29 bits: in a DBC file, add 2147483648 to its number");
    }
    return fail(what,
                "the codec " + codec + " reads " + wanted +
                    ", none of which came; on the bus: " + ids_text(facts.by_id),
                "correct odometry.codec or its identifiers; some bases must be told to send");
  }
  if (d.samples == 0) {
    const std::string bad = std::to_string(d.short_frames) + " too short, " +
                            std::to_string(d.invalid) + " invalid, " + std::to_string(d.unpaired) +
                            " without the other wheel's";
    return fail(what, "frames of " + codec + " came, but no travel: " + bad,
                "correct the section [odometry." + codec + "]");
  }
  if (facts.fault.kind != WheelFaultKind::kNone) {
    return fail(what, wheel_fault_text(facts.fault), "correct the section [odometry]",
                "candump -x can0");
  }
  const double rate = static_cast<double>(d.samples) / std::max(facts.seconds, 1e-3);
  std::string found = rate_text_of(static_cast<double>(d.samples), facts.seconds) + " by " + codec;
  found += facts.distinct_travel > 1 ? ", driving" : ", standing";
  if (d.error_reports > 0) {
    return warn(what, found + ", and a drive reports an error", "look at the base");
  }
  if (d.invalid + d.short_frames + d.late > 0) {
    return warn(what,
                found + ", " + std::to_string(d.invalid + d.short_frames + d.late) + " refused",
                "compare the codec with what the base sends", "candump -x can0");
  }
  constexpr double kGood_hz = 45.0;  // 50 Hz, measured over two seconds
  if (rate >= kGood_hz) return ok(what, found);
  return warn(what, found + ", 50 or more are better",
              "set the base to send its wheels more often: travel between samples is guessed");
}

}  // namespace zenith::tools
