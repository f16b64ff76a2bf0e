#include "sim/network.h"

#include <algorithm>
#include <cassert>

namespace zenith::sim {
namespace {

constexpr Duration kSecond = Duration::from_seconds(1.0);

}  // namespace

int Network::add(NetworkNode& node) {
  ports_.emplace_back().node = &node;
  for (std::vector<NetworkLink>& row : links_) row.emplace_back();
  links_.emplace_back(ports_.size());
  return static_cast<int>(ports_.size()) - 1;
}

NetworkLink& Network::link(int from, int to) {
  return links_[static_cast<std::size_t>(from)][static_cast<std::size_t>(to)];
}

void Network::set_all(const NetworkLink& link) {
  for (std::vector<NetworkLink>& row : links_) std::fill(row.begin(), row.end(), link);
}

void Network::partition(const std::vector<std::vector<int>>& groups) {
  for (std::vector<NetworkLink>& row : links_) {
    for (NetworkLink& l : row) l.up = false;
  }
  for (const std::vector<int>& group : groups) {
    for (const int a : group) {
      for (const int b : group) link(a, b).up = true;
    }
  }
}

void Network::heal() {
  for (std::vector<NetworkLink>& row : links_) {
    for (NetworkLink& l : row) l.up = true;
  }
}

void Network::run_until(Time end) {
  for (Port& port : ports_) port.wants = port.node->next_time(now_);
  while (true) {
    // What happens first: an arrival, or a node that wants to send.
    const auto port =
        std::min_element(ports_.begin(), ports_.end(),
                         [](const Port& a, const Port& b) { return a.wants < b.wants; });
    const Time next = port == ports_.end() ? end : std::min(port->wants, end);
    if (!arrivals_.empty() && arrivals_.top().at <= next) {
      const Arrival arrival = arrivals_.top();
      arrivals_.pop();
      now_ = std::max(now_, arrival.at);
      deliver(arrival);
      continue;
    }
    now_ = std::max(now_, next);
    if (next >= end) return;
    poll(static_cast<int>(port - ports_.begin()));
  }
}

void Network::poll(int node) {
  Port& port = ports_[static_cast<std::size_t>(node)];
  Datagram datagram;
  while (port.node->send(now_, datagram)) carry(node, datagram);
  // A node that promises and does not send must not stop time.
  port.wants = std::max(port.node->next_time(now_), now_ + Duration{100'000});
}

void Network::count(Port& port, std::size_t bytes) {
  ++port.traffic.sent_datagrams;
  port.traffic.sent_bytes += bytes;
  while (!port.last_second.empty() && now_ - port.last_second.front().at >= kSecond) {
    port.last_second_bytes -= port.last_second.front().bytes;
    port.last_second.pop_front();
  }
  port.last_second.push_back({now_, bytes});
  port.last_second_bytes += bytes;
  port.traffic.busiest_second_bytes =
      std::max(port.traffic.busiest_second_bytes, port.last_second_bytes);
}

void Network::carry(int from, const Datagram& datagram) {
  count(ports_[static_cast<std::size_t>(from)], datagram.bytes.size() + headers_);
  for (int to = 0; to < static_cast<int>(ports_.size()); ++to) {
    if (to == from || (datagram.to != kAllNodes && datagram.to != to)) continue;
    put_on_link(from, to, datagram.bytes);
  }
}

void Network::put_on_link(int from, int to, const std::vector<std::uint8_t>& bytes) {
  const NetworkLink& l = link(from, to);
  if (!l.up) return;
  const int copies = random_.uniform() < l.duplication ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    if (random_.uniform() < l.loss) continue;
    const double delay_s = l.delay_s + l.jitter_s * random_.uniform();
    Arrival arrival = {now_ + Duration::from_seconds(delay_s), order_++, from, to, bytes};
    if (!bytes.empty() && random_.uniform() < l.corruption) {
      ++corrupted_;
      const std::uint32_t at = random_.below(static_cast<std::uint32_t>(bytes.size()));
      arrival.bytes[at] ^= static_cast<std::uint8_t>(1 + random_.below(255));
    }
    arrivals_.push(std::move(arrival));
  }
}

void Network::deliver(const Arrival& arrival) {
  Port& port = ports_[static_cast<std::size_t>(arrival.to)];
  ++port.traffic.received_datagrams;
  port.traffic.received_bytes += arrival.bytes.size() + headers_;
  port.node->receive(now_, arrival.from, arrival.bytes);
  port.wants = port.node->next_time(now_);
}

}  // namespace zenith::sim
