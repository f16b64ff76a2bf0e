#pragma once
// Checks of what a robot needs to hear others: the fleet's key, a network that can multicast, and
// the membership of the daemon's group.

#include <string>
#include <vector>

#include "drivers/radio/interfaces.h"
#include "platform/daemon/config.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/machine_files.h"

namespace zenith::tools {

Finding check_fleet_key(const RadioConfig& radio);

// `usable`: by usable_interfaces(`wanted`, ...).
Finding check_network(const std::vector<Interface>& usable, const std::string& wanted);

// Interfaces on which this computer has joined the IPv4 group, by /proc/net/igmp.
std::vector<std::string> joined_interfaces(const MachineFiles& files, const std::string& group);
// `radio_runs`: a daemon with a key does. An empty group: listed addresses alone.
Finding check_group(const std::string& group, const std::vector<std::string>& joined,
                    bool radio_runs);

}  // namespace zenith::tools
