#pragma once
// Endpoints as people write them: "192.168.1.7:21474", "[fe80::1%wlan0]:21474".

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/endpoint.h"
#include "platform/base/result.h"

namespace zenith {

// Without a port: `default_port`. Numbers alone; no name is looked up. The interface behind % may
// be one that is not there (yet): its index is then 0.
Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t default_port);

// Several, with commas between them; empty: none.
Result<std::vector<Endpoint>> parse_endpoints(std::string_view text, std::uint16_t default_port);

// "239.255.90.78" or "ff02::5a4e"; the port is 0. An error when it is no multicast group.
Result<Endpoint> parse_group(std::string_view text);

std::string endpoint_text(const Endpoint& endpoint);

}  // namespace zenith
