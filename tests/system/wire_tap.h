#pragma once
// Listens on the switch of a NetWorld to what its computers send, as it is on the wire: UDP over
// IPv4, both headers counted.

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"
#include "tests/system/net_world.h"

namespace zenith {

struct WireCount {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;
  std::uint64_t busiest_second_bytes = 0;  // in any second, wherever it begins
};

class WireTap {
 public:
  WireTap() = default;
  ~WireTap();
  WireTap(const WireTap&) = delete;
  WireTap& operator=(const WireTap&) = delete;

  // False: not permitted here. Once.
  bool open(const NetWorld& world);
  // What a computer has sent until now.
  WireCount of(int computer) const;
  std::uint64_t missed() const;  // frames that the tap itself had no time for

 private:
  struct Sent {
    Time at;
    std::uint64_t bytes = 0;
  };
  struct Sender {
    WireCount count;
    std::deque<Sent> last_second;
    std::uint64_t last_second_bytes = 0;
  };
  void run();
  void note(Time at, int computer, std::uint64_t bytes);

  UniqueFd fd_;
  int bridge_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::map<int, Sender> senders_;
};

}  // namespace zenith
