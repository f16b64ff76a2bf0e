#include "tests/unit/drivers/odometry/fake_can.h"

#include <linux/can/raw.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace zenith {
namespace {

bool passes_filter(const std::vector<can_filter>& filters, canid_t id) {
  return std::any_of(filters.begin(), filters.end(), [id](const can_filter& filter) {
    return (id & filter.can_mask) == (filter.can_id & filter.can_mask);
  });
}

}  // namespace

can_frame raw_can(canid_t id, std::initializer_list<std::uint8_t> bytes) {
  can_frame frame = {};
  frame.can_id = id;
  frame.can_dlc = static_cast<__u8>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data);
  return frame;
}

void FakeCan::plug(const std::string& interface, bool up) {
  interfaces_[interface] = {next_index_++, up};
}

void FakeCan::unplug(const std::string& interface) {
  tell(interfaces_.at(interface).index, ENODEV);
  interfaces_.erase(interface);
}

void FakeCan::set_up(const std::string& interface, bool up) {
  Interface& known = interfaces_.at(interface);
  if (known.up && !up) tell(known.index, ENETDOWN);
  known.up = up;
}

void FakeCan::tell(int index, int error) {
  for (Socket& socket : sockets_) {
    if (socket.open && socket.index == index) socket.error = error;
  }
}

void FakeCan::send(const std::string& interface, const can_frame& frame) {
  const auto known = interfaces_.find(interface);
  if (known == interfaces_.end() || !known->second.up) return;
  for (Socket& socket : sockets_) {
    if (!socket.open || socket.index != known->second.index) continue;
    const bool error = (frame.can_id & CAN_ERR_FLAG) != 0;
    const bool wanted = error ? (frame.can_id & socket.errors & CAN_ERR_MASK) != 0
                              : passes_filter(socket.filters, frame.can_id);
    if (!wanted) continue;
    if (socket.queue.size() == kQueue) {
      ++socket.drops_sum;
      continue;
    }
    CanDatagram datagram;
    datagram.frame = frame;
    datagram.bytes = sizeof frame;
    if (socket.stamps) datagram.stamp_ns = now_.ns + wall_minus_monotonic_ns_;
    if (socket.counts_drops && socket.drops_sum != 0) datagram.drops_sum = socket.drops_sum;
    if (spoil) spoil(datagram);
    socket.queue.push_back(datagram);
  }
}

void FakeCan::send_at(Time when, const std::string& interface, const can_frame& frame) {
  later_.push_back({when, interface, frame});
}

void FakeCan::deliver_until(Time until) {
  while (!later_.empty() && later_.front().when <= until) {
    const Later next = later_.front();
    later_.erase(later_.begin());
    now_ = std::max(now_, next.when);
    send(next.interface, next.frame);
  }
}

void FakeCan::advance(Duration by) {
  const Time until = now_ + by;
  deliver_until(until);
  now_ = until;
}

std::vector<std::string> FakeCan::list() {
  std::vector<std::string> names;
  for (const auto& [name, interface] : interfaces_) names.push_back(name);
  return names;
}

int FakeCan::index_of(const char* interface) {
  const auto known = interfaces_.find(interface);
  return known != interfaces_.end() ? known->second.index : -ENODEV;
}

int FakeCan::is_up(int, const char* interface) {
  const auto known = interfaces_.find(interface);
  if (known == interfaces_.end()) return -ENODEV;
  return known->second.up ? 1 : 0;
}

int FakeCan::open() {
  if (open_error != 0) return -open_error;
  sockets_.emplace_back();
  sockets_.back().open = true;
  sockets_.back().drops_sum = first_drops_sum;
  ++open_sockets;
  return static_cast<int>(sockets_.size()) - 1;
}

void FakeCan::close(int fd) {
  sockets_.at(static_cast<std::size_t>(fd)).open = false;
  --open_sockets;
}

int FakeCan::set_option(int fd, int level, int option, const void* value, std::size_t bytes) {
  const auto failing = failing_options.find(option);
  if (failing != failing_options.end()) return -failing->second;
  Socket& socket = sockets_.at(static_cast<std::size_t>(fd));
  if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER) {
    socket.filters.resize(bytes / sizeof(can_filter));
    std::memcpy(socket.filters.data(), value, bytes);
  } else if (level == SOL_CAN_RAW && option == CAN_RAW_ERR_FILTER) {
    std::memcpy(&socket.errors, value, sizeof socket.errors);
  } else if (level == SOL_SOCKET && option == SO_TIMESTAMPNS) {
    socket.stamps = true;
  } else if (level == SOL_SOCKET && option == SO_RXQ_OVFL) {
    socket.counts_drops = true;
  } else {
    return -ENOPROTOOPT;
  }
  return 0;
}

int FakeCan::bind(int fd, int index) {
  for (const auto& [name, interface] : interfaces_) {
    if (interface.index != index) continue;
    sockets_.at(static_cast<std::size_t>(fd)).index = index;
    return 0;
  }
  return -ENODEV;
}

int FakeCan::receive(int fd, CanDatagram& out) {
  now_ = now_ + kBetweenCalls;
  deliver_until(now_);
  Socket& socket = sockets_.at(static_cast<std::size_t>(fd));
  if (socket.error != 0) return -std::exchange(socket.error, 0);
  if (socket.queue.empty()) return -EAGAIN;
  out = socket.queue.front();
  socket.queue.pop_front();
  return 0;
}

int FakeCan::poll(int fd, Duration timeout) {
  const Socket& socket = sockets_.at(static_cast<std::size_t>(fd));
  const Time until = now_ + timeout;
  while (true) {
    const int events = poll_events | (socket.queue.empty() ? 0 : POLLIN);
    if (events != 0) return events;
    if (socket.error != 0) return POLLERR;
    if (later_.empty() || later_.front().when > until) break;
    deliver_until(later_.front().when);
  }
  now_ = until;
  return 0;
}

Time FakeCan::now() {
  return now_;
}

CanClocks FakeCan::clocks() {
  return {now_, now_.ns + wall_minus_monotonic_ns_};
}

}  // namespace zenith
