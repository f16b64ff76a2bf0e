#include "drivers/radio/udp_radio.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "drivers/radio/endpoint_text.h"
#include "drivers/radio/socket_address.h"
#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

// A second of a busy fleet's news, while the thread does something else.
constexpr int kReceiveBuffer = 256 * 1024;
constexpr std::size_t kGroupSocket = 2;

std::uint16_t port_of(int number) {
  return static_cast<std::uint16_t>(number);
}

bool set(const UniqueFd& fd, int level, int option, int value) {
  return ::setsockopt(fd.get(), level, option, &value, sizeof value) == 0;
}

UniqueFd make_socket(bool ipv6) {
  UniqueFd fd(::socket(ipv6 ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return fd;
  (void)set(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
  (void)set(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBuffer);
  if (ipv6) (void)set(fd, IPPROTO_IPV6, IPV6_V6ONLY, 1);
  return fd;
}

Error socket_error(const std::string& what) {
  return Error{what + ": " + errno_text(errno)};
}

// The one control message of `message`, which has room for it.
template <typename Info>
void put_control(msghdr& message, int level, int type, const Info& info) {
  message.msg_controllen = CMSG_SPACE(sizeof info);
  cmsghdr* part = CMSG_FIRSTHDR(&message);
  part->cmsg_level = level;
  part->cmsg_type = type;
  part->cmsg_len = CMSG_LEN(sizeof info);
  std::memcpy(CMSG_DATA(part), &info, sizeof info);
}

std::uint16_t bound_port(const UniqueFd& fd) {
  SocketAddress address = {};
  socklen_t bytes = sizeof address;
  if (::getsockname(fd.get(), &address.any, &bytes) != 0) return 0;
  return to_endpoint(address).port;
}

}  // namespace

// --- what recvmmsg() needs -----------------------------------------------------------------------

struct UdpRadio::Batch {
  struct Slot {
    std::array<std::uint8_t, kMaxBytes> bytes;
    SocketAddress from;
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control;
    iovec data;
  };
  std::array<Slot, kBatch> slots;
  std::array<mmsghdr, kBatch> messages;

  void prepare() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      Slot& slot = slots[i];
      slot.data = {slot.bytes.data(), slot.bytes.size()};
      msghdr& header = messages[i].msg_hdr;
      header = {};
      header.msg_name = &slot.from;
      header.msg_namelen = sizeof slot.from;
      header.msg_iov = &slot.data;
      header.msg_iovlen = 1;
      header.msg_control = slot.control.data();
      header.msg_controllen = slot.control.size();
    }
  }

  // The kernel's count of dropped datagrams; false when it says nothing.
  bool drops(std::size_t i, std::uint32_t& sum) {
    msghdr& header = messages[i].msg_hdr;
    for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
         part = CMSG_NXTHDR(&header, part)) {
      if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL ||
          part->cmsg_len < CMSG_LEN(sizeof sum)) {
        continue;
      }
      std::memcpy(&sum, CMSG_DATA(part), sizeof sum);
      return true;
    }
    return false;
  }
};

// --- opening -------------------------------------------------------------------------------------

Status check(const RadioSettings& settings) {
  if (!settings.group.empty()) {
    if (const auto group = parse_group(settings.group); !group.ok()) return group.error();
  }
  const auto peers = parse_endpoints(settings.peers, port_of(settings.own_port));
  if (!peers.ok()) return peers.error();
  if (settings.group.empty() && peers->empty()) {
    return Error{"neither a group nor peers: nobody would be told anything"};
  }
  const bool without_port = std::any_of(peers->begin(), peers->end(),
                                        [](const Endpoint& peer) { return peer.port == 0; });
  if (without_port) return Error{"peers need ports when own_port is 0"};
  return {};
}

UdpRadio::UdpRadio(const RadioSettings& settings)
    : settings_(settings), batch_(std::make_unique<Batch>()) {
  if (const auto group = parse_group(settings.group); group.ok()) {
    group_ = *group;
    group_.port = port_of(settings.port);
    has_group_ = true;
  }
  auto peers = parse_endpoints(settings.peers, port_of(settings.own_port));
  if (peers.ok()) peers_ = std::move(*peers);
}

UdpRadio::~UdpRadio() = default;

Status UdpRadio::open() {
  close();
  for (const std::size_t family : {kIpv4, kIpv6}) {
    const auto is_of_family = [family](const Endpoint& e) {
      return e.is_ipv6 == (family == kIpv6);
    };
    const bool needed = (has_group_ && is_of_family(group_)) ||
                        std::any_of(peers_.begin(), peers_.end(), is_of_family);
    if (!needed) continue;
    if (const Status opened = open_own(family); !opened) {
      close();
      return opened;
    }
  }
  if (has_group_) {
    if (const Status opened = open_group(); !opened) {
      close();
      return opened;
    }
  }
  refresh();
  return {};
}

Status UdpRadio::open_own(std::size_t family) {
  const bool ipv6 = family == kIpv6;
  UniqueFd fd = make_socket(ipv6);
  if (!fd.is_open()) return socket_error(ipv6 ? "no IPv6 socket" : "no IPv4 socket");
  if (ipv6) {
    (void)set(fd, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, 1);
    (void)set(fd, IPPROTO_IPV6, IPV6_MULTICAST_LOOP, 1);
  } else {
    (void)set(fd, IPPROTO_IP, IP_MULTICAST_TTL, 1);
    (void)set(fd, IPPROTO_IP, IP_MULTICAST_LOOP, 1);
  }
  Endpoint any;
  any.is_ipv6 = ipv6;
  // Both families have one port, also one that the kernel chose for the first.
  any.port = own_port_ != 0 ? own_port_ : port_of(settings_.own_port);
  socklen_t bytes = 0;
  const SocketAddress address = to_socket_address(any, bytes);
  if (::bind(fd.get(), &address.any, bytes) != 0) {
    const Error error = socket_error("own port " + std::to_string(any.port));
    if (errno != EADDRINUSE) return error;
    return Error{error.message +
                 "; another program has it: give radio.own_port another number, or "
                 "0 for any that is free"};
  }
  own_port_ = bound_port(fd);
  own_[family] = std::move(fd);
  return {};
}

Status UdpRadio::open_group() {
  UniqueFd fd = make_socket(group_.is_ipv6);
  if (!fd.is_open()) return socket_error("no socket for the group");
  (void)set(fd, SOL_SOCKET, SO_REUSEADDR, 1);
  // Only what comes over interfaces that this socket joined itself.
  if (group_.is_ipv6) {
    (void)set(fd, IPPROTO_IPV6, IPV6_MULTICAST_ALL, 0);
  } else {
    (void)set(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0);
  }
  // Binding to a link-local group would tie the socket to one interface: there, to any address.
  Endpoint local = group_;
  if (group_.is_ipv6) local.address = {};
  socklen_t bytes = 0;
  const SocketAddress address = to_socket_address(local, bytes);
  if (::bind(fd.get(), &address.any, bytes) != 0) {
    return socket_error("group " + endpoint_text(group_));
  }
  group_socket_ = std::move(fd);
  return {};
}

void UdpRadio::close() {
  for (UniqueFd& fd : own_) fd.reset();
  group_socket_.reset();
  own_port_ = 0;
  joined_.clear();
  drops_seen_ = {};
}

void UdpRadio::refresh() {
  if (!is_open()) return;
  auto peers = parse_endpoints(settings_.peers, port_of(settings_.own_port));
  if (peers.ok()) peers_ = std::move(*peers);
  if (!has_group_) return;
  std::vector<Interface> joined;
  for (const Interface& interface : usable_interfaces(settings_.interface, group_.is_ipv6)) {
    if (joined.size() < kMaxInterfaces && join(interface)) joined.push_back(interface);
  }
  joined_ = std::move(joined);
}

// True also when it is joined already: asking again is how a lost membership is found.
bool UdpRadio::join(const Interface& interface) {
  int result = 0;
  if (group_.is_ipv6) {
    ipv6_mreq request = {};
    std::memcpy(&request.ipv6mr_multiaddr, group_.address.data(), sizeof request.ipv6mr_multiaddr);
    request.ipv6mr_interface = interface.index;
    result =
        ::setsockopt(group_socket_.get(), IPPROTO_IPV6, IPV6_JOIN_GROUP, &request, sizeof request);
  } else {
    ip_mreqn request = {};
    std::memcpy(&request.imr_multiaddr, group_.address.data(), sizeof request.imr_multiaddr);
    request.imr_ifindex = static_cast<int>(interface.index);
    result =
        ::setsockopt(group_socket_.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request);
  }
  if (result == 0) ++counters_.joins;
  return result == 0 || errno == EADDRINUSE;
}

std::string UdpRadio::joined_text() const {
  std::string text;
  for (const Interface& interface : joined_) text += (text.empty() ? "" : ", ") + interface.name;
  return text;
}

// --- receiving -----------------------------------------------------------------------------------

void UdpRadio::wait(Duration timeout) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(timeout.ns, 0);
  if (!is_open()) return sleep_until(monotonic_now() + Duration{ns});
  // Those that are not open have fd -1, which poll passes over.
  std::array<pollfd, 3> entries = {{{own_[kIpv4].get(), POLLIN, 0},
                                    {own_[kIpv6].get(), POLLIN, 0},
                                    {group_socket_.get(), POLLIN, 0}}};
  const timespec wait = {static_cast<time_t>(ns / kSecond_ns), static_cast<long>(ns % kSecond_ns)};
  (void)::ppoll(entries.data(), entries.size(), &wait, nullptr);
}

std::span<const RadioDatagram> UdpRadio::receive() {
  // In turns, so that a flood on one socket does not hide the others.
  for (std::size_t i = 0; i < drops_seen_.size(); ++i) {
    const std::size_t socket = next_socket_;
    next_socket_ = (next_socket_ + 1) % drops_seen_.size();
    const std::size_t count = receive_from(socket);
    if (count > 0) return std::span<const RadioDatagram>(received_).first(count);
  }
  return {};
}

std::size_t UdpRadio::receive_from(std::size_t socket) {
  const int fd = socket == kGroupSocket ? group_socket_.get() : own_[socket].get();
  if (fd < 0) return 0;
  // A batch of nothing but what is not ours does not end the reading.
  for (int tries = 0; tries < 4; ++tries) {
    batch_->prepare();
    const int count = ::recvmmsg(fd, batch_->messages.data(), kBatch, MSG_DONTWAIT, nullptr);
    if (count <= 0) return 0;
    std::size_t good = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      std::uint32_t sum = 0;
      if (batch_->drops(i, sum)) note_drops(socket, sum);
      if ((batch_->messages[i].msg_hdr.msg_flags & MSG_TRUNC) != 0) {
        ++counters_.too_long;
        continue;
      }
      const Batch::Slot& slot = batch_->slots[i];
      received_[good++] = {to_endpoint(slot.from),
                           std::span(slot.bytes).first(batch_->messages[i].msg_len)};
    }
    counters_.received += good;
    if (good > 0) return good;
  }
  return 0;
}

void UdpRadio::note_drops(std::size_t socket, std::uint32_t sum) {
  counters_.dropped += sum - drops_seen_[socket];  // wraps with the kernel's
  drops_seen_[socket] = sum;
}

// --- sending -------------------------------------------------------------------------------------

void UdpRadio::send(const Endpoint& to, std::span<const std::uint8_t> bytes) {
  send_on(to, 0, bytes);
}

void UdpRadio::send_to_everybody(std::span<const std::uint8_t> bytes) {
  for (const Interface& interface : joined_) send_on(group_, interface.index, bytes);
  if (has_group_ && joined_.empty()) note_sent(ENETUNREACH);
  for (const Endpoint& peer : peers_) send_on(peer, 0, bytes);
}

int UdpRadio::copies_to_everybody() const {
  return (has_group_ ? 1 : 0) + static_cast<int>(peers_.size());
}

// `interface`: of a multicast; 0: as the routes say.
void UdpRadio::send_on(const Endpoint& to, std::uint32_t interface,
                       std::span<const std::uint8_t> bytes) {
  const UniqueFd& fd = own_[to.is_ipv6 ? kIpv6 : kIpv4];
  if (!fd.is_open()) return note_sent(ENETUNREACH);
  socklen_t address_bytes = 0;
  SocketAddress address = to_socket_address(to, address_bytes);
  iovec data = {const_cast<std::uint8_t*>(bytes.data()), bytes.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(in6_pktinfo))> control = {};
  msghdr message = {};
  message.msg_name = &address;
  message.msg_namelen = address_bytes;
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  if (interface == 0) {
    message.msg_controllen = 0;
  } else if (to.is_ipv6) {
    in6_pktinfo info = {};
    info.ipi6_ifindex = interface;
    put_control(message, IPPROTO_IPV6, IPV6_PKTINFO, info);
  } else {
    in_pktinfo info = {};
    info.ipi_ifindex = static_cast<int>(interface);
    put_control(message, IPPROTO_IP, IP_PKTINFO, info);
  }
  const ssize_t sent = ::sendmsg(fd.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  note_sent(sent < 0 ? errno : 0);
}

void UdpRadio::note_sent(int error) {
  switch (error) {
    case 0:
      ++counters_.sent;
      break;
    case ENETUNREACH:
    case EHOSTUNREACH:
    case ENETDOWN:
    case EADDRNOTAVAIL:
    case ENODEV:
      ++counters_.unreachable;
      break;
    case ENOBUFS:
    case EAGAIN:
    case ENOMEM:
      ++counters_.no_buffer;
      break;
    case EPERM:
    case EACCES:
      ++counters_.forbidden;
      break;
    default:
      ++counters_.not_sent;
  }
  sent_in_a_row_ = error == 0 ? sent_in_a_row_ + 1 : 0;
  if (error != 0) trouble_ = error;
  if (sent_in_a_row_ == kGoodAgain) trouble_ = 0;
}

bool UdpRadio::next_news(std::string& out) {
  if (trouble_ == told_) return false;
  told_ = trouble_;
  out = told_ == 0 ? "radio: sending again" : "radio: cannot send: " + errno_text(told_);
  return true;
}

}  // namespace zenith
