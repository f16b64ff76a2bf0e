#pragma once
// CAN interfaces that exist in memory only, on clocks that move only when somebody waits: the
// kernel's side of raw CAN sockets, with its filters, queues, stamps and errors.

#include <linux/can.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "drivers/odometry/can_io.h"

namespace zenith {

class FakeCan final : public CanIo {
 public:
  static constexpr std::size_t kQueue = 100;  // datagrams that a socket holds
  static constexpr Duration kBetweenCalls = {1'000};

  // --- the world's side ---
  void plug(const std::string& interface, bool up = true);  // with an index of its own
  void unplug(const std::string& interface);
  void set_up(const std::string& interface, bool up);
  // On the interface, now or later.
  void send(const std::string& interface, const can_frame& frame);
  void send_at(Time when, const std::string& interface, const can_frame& frame);
  void step_wall_clock(Duration by) { wall_minus_monotonic_ns_ += by.ns; }
  void advance(Duration by);
  // A datagram as it will be received.
  std::function<void(CanDatagram&)> spoil;
  std::map<int, int> failing_options;  // option -> errno
  int open_error = 0;
  int poll_events = 0;  // what poll() says besides POLLIN
  int open_sockets = 0;
  std::uint32_t first_drops_sum = 0;

  // --- the kernel's side ---
  std::vector<std::string> list() override;
  int index_of(const char* interface) override;
  int is_up(int fd, const char* interface) override;
  int open() override;
  void close(int fd) override;
  int set_option(int fd, int level, int option, const void* value, std::size_t bytes) override;
  int bind(int fd, int index) override;
  int receive(int fd, CanDatagram& out) override;
  int poll(int fd, Duration timeout) override;
  Time now() override;
  CanClocks clocks() override;

 private:
  struct Interface {
    int index = 0;
    bool up = false;
  };
  struct Socket {
    bool open = false;
    int index = 0;
    int error = 0;  // told by the next receive()
    std::vector<can_filter> filters = {{0, 0}};
    can_err_mask_t errors = 0;
    bool stamps = false;
    bool counts_drops = false;
    std::uint32_t drops_sum = 0;
    std::deque<CanDatagram> queue;
  };
  struct Later {
    Time when;
    std::string interface;
    can_frame frame;
  };

  void tell(int index, int error);
  void deliver_until(Time until);

  std::map<std::string, Interface> interfaces_;
  std::vector<Socket> sockets_;  // by file descriptor
  std::vector<Later> later_;     // in order of time
  int next_index_ = 4;
  Time now_ = {5'000'000'000'000};
  std::int64_t wall_minus_monotonic_ns_ = 1'700'000'000'000'000'000;
};

// `id` with the kernel's flags.
can_frame raw_can(canid_t id, std::initializer_list<std::uint8_t> bytes);

}  // namespace zenith
