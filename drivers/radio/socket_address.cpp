#include "drivers/radio/socket_address.h"

#include <cstring>

namespace zenith {

SocketAddress to_socket_address(const Endpoint& endpoint, socklen_t& bytes) {
  SocketAddress address = {};
  if (endpoint.is_ipv6) {
    address.ipv6 = {};
    address.ipv6.sin6_family = AF_INET6;
    address.ipv6.sin6_port = htons(endpoint.port);
    address.ipv6.sin6_scope_id = endpoint.interface;
    std::memcpy(&address.ipv6.sin6_addr, endpoint.address.data(), sizeof address.ipv6.sin6_addr);
    bytes = sizeof address.ipv6;
  } else {
    address.ipv4 = {};
    address.ipv4.sin_family = AF_INET;
    address.ipv4.sin_port = htons(endpoint.port);
    std::memcpy(&address.ipv4.sin_addr, endpoint.address.data(), sizeof address.ipv4.sin_addr);
    bytes = sizeof address.ipv4;
  }
  return address;
}

Endpoint to_endpoint(const SocketAddress& address) {
  Endpoint endpoint;
  endpoint.is_ipv6 = address.any.sa_family == AF_INET6;
  if (endpoint.is_ipv6) {
    endpoint.port = ntohs(address.ipv6.sin6_port);
    endpoint.interface = address.ipv6.sin6_scope_id;
    std::memcpy(endpoint.address.data(), &address.ipv6.sin6_addr, sizeof address.ipv6.sin6_addr);
  } else {
    endpoint.port = ntohs(address.ipv4.sin_port);
    std::memcpy(endpoint.address.data(), &address.ipv4.sin_addr, sizeof address.ipv4.sin_addr);
  }
  return endpoint;
}

}  // namespace zenith
