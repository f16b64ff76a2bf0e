#include "tests/system/wire_tap.h"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>

namespace zenith {
namespace {

constexpr Duration kSecond = {1'000'000'000};

// The kernel's, so that it does not matter when this thread finds time.
Time stamp_of(const msghdr& message) {
  for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
       c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp = {};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    return Time{stamp.tv_sec * kSecond.ns + stamp.tv_nsec};
  }
  return {};
}

}  // namespace

bool WireTap::open(const NetWorld& world) {
  (void)world.on_the_switch([&] {
    bridge_ = static_cast<int>(::if_nametoindex("br0"));
    fd_ = UniqueFd(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_ALL)));
  });
  if (!fd_.is_open()) return false;
  const int yes = 1;
  if (::setsockopt(fd_.get(), SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes) != 0) return false;
  const int room = 8 << 20;
  (void)::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
  thread_ = std::thread([this] { run(); });
  return true;
}

WireTap::~WireTap() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void WireTap::run() {
  while (!stop_) {
    pollfd ready = {fd_.get(), POLLIN, 0};
    if (::poll(&ready, 1, 50) <= 0) continue;
    std::array<std::uint8_t, 64> head;
    sockaddr_ll from = {};
    alignas(cmsghdr) std::array<char, 256> control;
    iovec part = {head.data(), head.size()};
    msghdr message = {};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = ::recvmsg(fd_.get(), &message, MSG_DONTWAIT);
    // Once for each datagram: where it comes in, not where the switch passes it on or takes it
    // itself.
    constexpr ssize_t kIpv4 = 20;
    if (count < kIpv4 || from.sll_protocol != htons(ETH_P_IP)) continue;
    if (from.sll_pkttype == PACKET_OUTGOING || from.sll_ifindex == bridge_) continue;
    if (head[9] != IPPROTO_UDP) continue;
    const std::uint64_t bytes = std::uint64_t{head[2]} << 8U | head[3];
    note(stamp_of(message), head[15], bytes);
  }
}

void WireTap::note(Time at, int computer, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  Sender& sender = senders_[computer];
  ++sender.count.datagrams;
  sender.count.bytes += bytes;
  auto& last = sender.last_second;
  for (; !last.empty() && at - last.front().at >= kSecond; last.pop_front()) {
    sender.last_second_bytes -= last.front().bytes;
  }
  last.push_back({at, bytes});
  sender.last_second_bytes += bytes;
  sender.count.busiest_second_bytes =
      std::max(sender.count.busiest_second_bytes, sender.last_second_bytes);
}

WireCount WireTap::of(int computer) const {
  const std::lock_guard lock(mutex_);
  const auto found = senders_.find(computer);
  return found == senders_.end() ? WireCount{} : found->second.count;
}

std::uint64_t WireTap::missed() const {
  tpacket_stats stats = {};
  socklen_t size = sizeof stats;
  (void)::getsockopt(fd_.get(), SOL_PACKET, PACKET_STATISTICS, &stats, &size);
  return stats.tp_drops;
}

}  // namespace zenith
