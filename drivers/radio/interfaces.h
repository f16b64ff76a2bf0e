#pragma once
// The network interfaces over which robots may be reached.

#include <cstdint>
#include <string>
#include <vector>

namespace zenith {

struct Interface {
  std::string name;
  std::uint32_t index = 0;
};

// Those that are up and have an address of the family: the named one, or with an empty name all
// that can multicast. When these are none: the loopback interface, so that programs on one computer
// hear each other. None at all is a normal state, at boot for instance.
std::vector<Interface> usable_interfaces(const std::string& name, bool ipv6);

}  // namespace zenith
