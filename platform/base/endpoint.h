#pragma once
// Where a datagram comes from or goes to: an address of IPv4 or IPv6 and a port, as plain data.

#include <array>
#include <cstdint>

namespace zenith {

struct Endpoint {
  bool is_ipv6 = false;
  std::array<std::uint8_t, 16> address = {};  // in the network's order; IPv4: the first four
  std::uint32_t interface = 0;                // index, for link-local IPv6 addresses; else 0
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

}  // namespace zenith
