#include "tools/doctor/can_link.h"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstring>

#include "platform/linux/unique_fd.h"
#include "platform/linux/wait_readable.h"

namespace zenith::tools {
namespace {

constexpr long long kCanType = 280;  // ARPHRD_CAN
constexpr long long kFlagUp = 1;     // IFF_UP

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t padded(std::size_t length) {
  return (length + 3) & ~std::size_t{3};
}

// The content of the first attribute of this type in a row of attributes.
Bytes attribute(Bytes row, unsigned short wanted) {
  while (row.size() >= sizeof(rtattr)) {
    rtattr head = {};
    std::memcpy(&head, row.data(), sizeof(head));
    if (head.rta_len < sizeof(head) || head.rta_len > row.size()) return {};
    if ((head.rta_type & NLA_TYPE_MASK) == wanted) {
      return row.subspan(sizeof(head), head.rta_len - sizeof(head));
    }
    row = row.subspan(std::min(row.size(), padded(head.rta_len)));
  }
  return {};
}

// The u32 at the begin of an attribute, or nothing.
std::optional<std::uint32_t> word(Bytes content) {
  std::uint32_t value = 0;
  if (content.size() < sizeof(value)) return std::nullopt;
  std::memcpy(&value, content.data(), sizeof(value));
  return value;
}

}  // namespace

std::string ask_can_controller(const std::string& interface) {
  const unsigned index = ::if_nametoindex(interface.c_str());
  const UniqueFd fd(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (index == 0 || !fd.is_open()) return {};
  struct {
    nlmsghdr header;
    ifinfomsg link;
  } request = {};
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.link.ifi_family = AF_UNSPEC;
  request.link.ifi_index = static_cast<int>(index);
  if (::send(fd.get(), &request, sizeof(request), 0) < 0) return {};
  if (wait_readable(fd.get(), {1'000'000'000}) <= 0) return {};
  std::array<char, 16384> answer;
  const ssize_t size = ::recv(fd.get(), answer.data(), answer.size(), 0);
  return size > 0 ? std::string(answer.data(), static_cast<std::size_t>(size)) : std::string();
}

CanController parse_can_controller(Bytes answer) {
  CanController controller;
  nlmsghdr header = {};
  constexpr std::size_t kHead = sizeof(nlmsghdr) + sizeof(ifinfomsg);
  if (answer.size() < kHead) return controller;
  std::memcpy(&header, answer.data(), sizeof(header));
  if (header.nlmsg_type != RTM_NEWLINK) return controller;
  const Bytes info = attribute(answer.subspan(kHead), IFLA_LINKINFO);
  const Bytes kind = attribute(info, IFLA_INFO_KIND);
  const char* name = reinterpret_cast<const char*>(kind.data());
  if (!kind.empty()) controller.kind.assign(name, ::strnlen(name, kind.size()));
  const Bytes data = attribute(info, IFLA_INFO_DATA);
  if (controller.kind != "can") return controller;
  controller.state = word(attribute(data, IFLA_CAN_STATE));
  controller.bitrate = word(attribute(data, IFLA_CAN_BITTIMING));  // its first field
  controller.restart_ms = word(attribute(data, IFLA_CAN_RESTART_MS));
  const Bytes errors = attribute(data, IFLA_CAN_BERR_COUNTER);  // u16 transmit, u16 receive
  if (const auto both = word(errors)) {
    std::array<std::uint16_t, 2> counts = {};
    std::memcpy(counts.data(), errors.data(), sizeof(counts));
    controller.transmit_errors = counts[0];
    controller.receive_errors = counts[1];
  }
  return controller;
}

CanLink read_can_link(const MachineFiles& files, const std::string& interface) {
  CanLink link;
  const std::string folder = "/sys/class/net/" + interface + "/";
  link.exists = files.exists(folder);
  link.is_can = files.number(folder + "type") == kCanType;
  link.up = (files.number(folder + "flags").value_or(0) & kFlagUp) != 0;
  const auto count = [&](const char* name) {
    const auto value = files.number(folder + "statistics/" + name);
    return static_cast<std::uint64_t>(value.value_or(0));
  };
  link.received = count("rx_packets");
  link.receive_errors = count("rx_errors");
  link.receive_dropped = count("rx_dropped");
  return link;
}

}  // namespace zenith::tools
