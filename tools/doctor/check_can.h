#pragma once
// Checks of the CAN bus: the interface, its controller, what comes, and whether the codec reads it.

#include <map>
#include <string>
#include <vector>

#include "drivers/odometry/can_bus.h"
#include "drivers/odometry/wheel_decoder.h"
#include "tools/doctor/can_link.h"
#include "tools/doctor/finding.h"

namespace zenith::tools {

// `others`: CAN interfaces that there are.
Finding check_can_interface(const std::string& name, const CanLink& link,
                            const std::vector<std::string>& others);
Finding check_can_controller(const std::string& name, const CanLink& link);

struct TrafficFacts {
  std::string problem;  // it could not be opened
  double seconds = 0.0;
  std::map<CanId, std::uint64_t> by_id;
  WheelDecoderCounters decoder;
  WheelFault fault;
  CanCounters counters;
  std::uint64_t distinct_travel = 0;  // samples that moved: the base drives
};

// Listens to all identifiers on an own socket, which disturbs nobody.
TrafficFacts listen_to(CanBus& bus, WheelDecoder decoder, Duration how_long);

Finding check_can_traffic(const std::string& name, const TrafficFacts& facts);
Finding check_wheels(const TrafficFacts& facts, const CanIds& expected, const std::string& codec);

// Names of CAN interfaces in /sys/class/net.
std::vector<std::string> list_can_interfaces(const MachineFiles& files);

}  // namespace zenith::tools
