#include "drivers/radio/endpoint_text.h"

#include <arpa/inet.h>
#include <net/if.h>

#include <algorithm>
#include <charconv>

namespace zenith {
namespace {

bool parse_port(std::string_view text, std::uint16_t& out) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), out);
  return status == std::errc() && end == text.data() + text.size() && out != 0;
}

bool parse_address(std::string_view text, Endpoint& out) {
  const std::size_t percent = text.find('%');
  const std::string address(text.substr(0, percent));
  out.is_ipv6 = address.find(':') != std::string::npos;
  if (::inet_pton(out.is_ipv6 ? AF_INET6 : AF_INET, address.c_str(), out.address.data()) != 1) {
    return false;
  }
  if (percent == std::string_view::npos) return true;
  const std::string interface(text.substr(percent + 1));
  out.interface = ::if_nametoindex(interface.c_str());
  return out.is_ipv6 && !interface.empty() && interface.size() < IF_NAMESIZE;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

bool is_multicast(const Endpoint& endpoint) {
  return endpoint.is_ipv6 ? endpoint.address[0] == 0xFF : endpoint.address[0] >> 4 == 14;
}

}  // namespace

Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t default_port) {
  Endpoint endpoint;
  endpoint.port = default_port;
  bool good = false;
  if (!text.empty() && text[0] == '[') {
    const std::size_t close = std::min(text.find(']'), text.size());
    const std::string_view behind = text.substr(std::min(close + 1, text.size()));
    good = close < text.size() && parse_address(text.substr(1, close - 1), endpoint) &&
           endpoint.is_ipv6 &&
           (behind.empty() || (behind[0] == ':' && parse_port(behind.substr(1), endpoint.port)));
  } else {
    const bool has_port = std::count(text.begin(), text.end(), ':') == 1;
    const std::size_t colon = has_port ? text.find(':') : text.size();
    good = parse_address(text.substr(0, colon), endpoint) &&
           (!has_port || parse_port(text.substr(colon + 1), endpoint.port));
  }
  if (!good) {
    return Error{
        "expected an address such as \"192.168.1.7\", \"192.168.1.7:21474\" or "
        "\"[fe80::1%wlan0]:21474\", found \"" +
        std::string(text) + "\""};
  }
  return endpoint;
}

Result<std::vector<Endpoint>> parse_endpoints(std::string_view text, std::uint16_t default_port) {
  std::vector<Endpoint> endpoints;
  if (trimmed(text).empty()) return endpoints;
  while (true) {
    const std::size_t comma = text.find(',');
    auto endpoint = parse_endpoint(trimmed(text.substr(0, comma)), default_port);
    if (!endpoint.ok()) return endpoint.error();
    endpoints.push_back(*endpoint);
    if (comma == std::string_view::npos) return endpoints;
    text.remove_prefix(comma + 1);
  }
}

Result<Endpoint> parse_group(std::string_view text) {
  Endpoint group;
  if (!parse_address(text, group) || !is_multicast(group) ||
      text.find('%') != std::string_view::npos) {
    return Error{
        "expected a multicast group such as \"239.255.90.78\" or \"ff02::5a4e\", found \"" +
        std::string(text) + "\""};
  }
  return group;
}

std::string endpoint_text(const Endpoint& endpoint) {
  char address[INET6_ADDRSTRLEN] = "";
  ::inet_ntop(endpoint.is_ipv6 ? AF_INET6 : AF_INET, endpoint.address.data(), address,
              sizeof address);
  if (!endpoint.is_ipv6) return std::string(address) + ":" + std::to_string(endpoint.port);
  std::string interface;
  char name[IF_NAMESIZE] = "";
  if (endpoint.interface != 0) {
    const bool known = ::if_indextoname(endpoint.interface, name) != nullptr;
    interface = "%" + (known ? std::string(name) : std::to_string(endpoint.interface));
  }
  return "[" + std::string(address) + interface + "]:" + std::to_string(endpoint.port);
}

}  // namespace zenith
