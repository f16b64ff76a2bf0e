#include "tools/doctor/check_fleet.h"

#include <arpa/inet.h>

#include <cstdio>
#include <sstream>

#include "platform/link/fleet_key.h"

namespace zenith::tools {

Finding check_fleet_key(const RadioConfig& radio) {
  const std::string what = "fleet key";
  const std::string& file = radio.key_file;
  if (!radio.enabled) return skip(what, "radio.enabled = false: this robot maps alone");
  if (file.empty()) {
    return skip(what, "radio.key_file names none: this robot maps alone; `zenith key --help`");
  }
  const auto keys = read_fleet_keys(file);
  if (!keys) return fail(what, keys.error().message, "", "zenith key --help");
  return ok(what, file + ", key " + keys_text(*keys) + "; it must be the same on all robots");
}

Finding check_network(const std::vector<Interface>& usable, const std::string& wanted) {
  const std::string what = "network";
  std::string names;
  bool beyond = false;
  for (const Interface& interface : usable) {
    names += (names.empty() ? "" : ", ") + interface.name;
    beyond = beyond || interface.name != "lo";
  }
  if (beyond) return ok(what, names + " can multicast");
  const std::string found =
      wanted.empty() ? "no interface is up that can multicast" : wanted + " is not up";
  return warn(what, found, "connect it to the robots' network: without it this robot maps alone",
              "ip -brief address");
}

std::vector<std::string> joined_interfaces(const MachineFiles& files, const std::string& group) {
  in_addr wanted = {};
  std::vector<std::string> joined;
  const auto text = files.read("/proc/net/igmp");
  if (!text || ::inet_pton(AF_INET, group.c_str(), &wanted) != 1) return joined;
  // "2  eth0  : 1  V3" and below it a line for each group, the address as the machine keeps it:
  // "        4E5AFFEF     1 0:00000000  1"
  char address[16];
  std::snprintf(address, sizeof address, "%08X", wanted.s_addr);
  std::istringstream lines(*text);
  std::string interface;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    std::string second;
    words >> first >> second;
    if (!line.empty() && line[0] != '\t' && line[0] != ' ') {
      interface = second;
    } else if (first == address) {
      joined.push_back(interface);
    }
  }
  return joined;
}

Finding check_group(const std::string& group, const std::vector<std::string>& joined,
                    bool radio_runs) {
  const std::string what = "multicast group";
  if (group.empty()) return skip(what, "radio.group is empty: listed addresses alone");
  if (group.find(':') != std::string::npos) return skip(what, "of IPv6, not looked up");
  std::string names;
  for (const std::string& name : joined) names += (names.empty() ? "" : ", ") + name;
  if (!joined.empty()) return ok(what, group + " is joined on " + names);
  if (!radio_runs) return skip(what, "nobody has joined " + group + ": zenithd does when it runs");
  return fail(what, "zenithd runs and has not joined " + group,
              "no interface is up that can multicast, or radio.interface names another");
}

}  // namespace zenith::tools
