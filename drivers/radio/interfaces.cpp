#include "drivers/radio/interfaces.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>

namespace zenith {
namespace {

bool is_up(const ifaddrs& entry, bool ipv6) {
  return entry.ifa_addr != nullptr && entry.ifa_addr->sa_family == (ipv6 ? AF_INET6 : AF_INET) &&
         (entry.ifa_flags & IFF_UP) != 0;
}

bool is_wanted(const ifaddrs& entry, const std::string& name) {
  if (!name.empty()) return entry.ifa_name == name;
  return (entry.ifa_flags & IFF_MULTICAST) != 0 && (entry.ifa_flags & IFF_LOOPBACK) == 0;
}

void add(std::vector<Interface>& to, const ifaddrs& entry) {
  const std::uint32_t index = ::if_nametoindex(entry.ifa_name);
  const bool known =
      std::any_of(to.begin(), to.end(), [index](const Interface& i) { return i.index == index; });
  if (index != 0 && !known) to.push_back({entry.ifa_name, index});
}

}  // namespace

std::vector<Interface> usable_interfaces(const std::string& name, bool ipv6) {
  std::vector<Interface> wanted;
  std::vector<Interface> loopback;
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return wanted;
  for (const ifaddrs* entry = all; entry != nullptr; entry = entry->ifa_next) {
    if (!is_up(*entry, ipv6)) continue;
    if (is_wanted(*entry, name)) add(wanted, *entry);
    if ((entry->ifa_flags & IFF_LOOPBACK) != 0) add(loopback, *entry);
  }
  ::freeifaddrs(all);
  return wanted.empty() && name.empty() ? loopback : wanted;
}

}  // namespace zenith
