#pragma once
// Endpoints as the kernel wants them.

#include <netinet/in.h>
#include <sys/socket.h>

#include "platform/base/endpoint.h"

namespace zenith {

union SocketAddress {
  sockaddr any;
  sockaddr_in ipv4;
  sockaddr_in6 ipv6;
};

SocketAddress to_socket_address(const Endpoint& endpoint, socklen_t& bytes);
Endpoint to_endpoint(const SocketAddress& address);

}  // namespace zenith
