#pragma once
// A made-up radio network in one process, faster than real time: datagrams are lost, late, out of
// order, doubled, damaged; links fail one way or both. The same seed gives the same run.
//
// Nodes are anything that sends and takes whole UDP payloads. Time is simulated; it starts at 0.

#include <cstdint>
#include <deque>
#include <queue>
#include <span>
#include <vector>

#include "platform/base/random.h"
#include "platform/base/time.h"

namespace zenith::sim {

inline constexpr int kAllNodes = -1;

struct Datagram {
  int to = kAllNodes;  // a node, or all others
  std::vector<std::uint8_t> bytes;
};

class NetworkNode {
 public:
  virtual ~NetworkNode() = default;
  virtual void receive(Time now, int from, std::span<const std::uint8_t> bytes) = 0;
  // The next datagram that is due; false when none is.
  virtual bool send(Time now, Datagram& out) = 0;
  // When send() will have something, if nothing comes in before.
  virtual Time next_time(Time now) = 0;
};

// One direction between two nodes.
struct NetworkLink {
  bool up = true;
  double loss = 0.0;  // share of datagrams; also of `duplication` and `corruption`
  double duplication = 0.0;
  double corruption = 0.0;  // one byte becomes another
  double delay_s = 0.002;
  // Added, evenly distributed: more than the time between datagrams changes their order.
  double jitter_s = 0.001;
};

// Of one node; bytes with all headers. One datagram to all counts once: the medium is shared.
struct NetworkTraffic {
  std::uint64_t sent_datagrams = 0;
  std::uint64_t sent_bytes = 0;
  std::uint64_t received_datagrams = 0;
  std::uint64_t received_bytes = 0;
  std::uint64_t busiest_second_bytes = 0;  // sent in any second, wherever it begins
};

class Network {
 public:
  // Bytes of the headers below UDP's payload.
  explicit Network(std::uint64_t seed, std::size_t headers = 28)
      : random_(seed), headers_(headers) {}

  // Returns its number. The node must outlive the network.
  int add(NetworkNode& node);
  NetworkLink& link(int from, int to);
  void set_all(const NetworkLink& link);
  // Links within a group stay up, those between groups fail both ways. Nodes that no group names
  // are alone.
  void partition(const std::vector<std::vector<int>>& groups);
  void heal();  // all links up

  Time now() const { return now_; }
  void run_until(Time end);
  void run_for(double seconds) { run_until(now_ + Duration::from_seconds(seconds)); }

  const NetworkTraffic& traffic(int node) const {
    return ports_[static_cast<std::size_t>(node)].traffic;
  }
  std::uint64_t corrupted() const { return corrupted_; }

 private:
  struct Sent {
    Time at;
    std::size_t bytes = 0;
  };
  struct Port {
    NetworkNode* node = nullptr;
    Time wants;  // to send
    NetworkTraffic traffic;
    std::deque<Sent> last_second;
    std::uint64_t last_second_bytes = 0;
  };
  struct Arrival {
    Time at;
    std::uint64_t order = 0;  // of sending, where times are equal
    int from = 0;
    int to = 0;
    std::vector<std::uint8_t> bytes;

    bool operator>(const Arrival& b) const { return at != b.at ? at > b.at : order > b.order; }
  };

  void poll(int node);
  void count(Port& port, std::size_t bytes);
  void carry(int from, const Datagram& datagram);
  void put_on_link(int from, int to, const std::vector<std::uint8_t>& bytes);
  void deliver(const Arrival& arrival);

  Random random_;
  std::size_t headers_;
  Time now_;
  std::uint64_t order_ = 0;
  std::uint64_t corrupted_ = 0;
  std::vector<Port> ports_;
  std::vector<std::vector<NetworkLink>> links_;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> arrivals_;
};

}  // namespace zenith::sim
