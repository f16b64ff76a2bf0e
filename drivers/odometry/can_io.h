#pragma once
// The few system calls that the SocketCAN bus makes, so that tests can stand in for the kernel.
//
// Results below zero are -errno. receive(), poll(), now() and clocks() are called by the realtime
// thread.

#include <linux/can.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/time.h"

namespace zenith {

// One frame as a raw CAN socket gives it, with what the kernel says beside it.
struct CanDatagram {
  can_frame frame = {};
  std::size_t bytes = 0;                   // of the frame; fewer than a classic frame's: not one
  std::optional<std::int64_t> stamp_ns;    // CLOCK_REALTIME, at reception
  std::optional<std::uint32_t> drops_sum;  // dropped since the socket is open; wraps at 32 bits
};

// Both clocks at one moment.
struct CanClocks {
  Time monotonic;
  std::int64_t realtime_ns = 0;
};

class CanIo {
 public:
  CanIo() = default;
  CanIo(const CanIo&) = delete;
  CanIo& operator=(const CanIo&) = delete;
  virtual ~CanIo() = default;

  // Names of the CAN interfaces that there are.
  virtual std::vector<std::string> list() = 0;
  // Its index, which changes when it is unplugged and plugged in again.
  virtual int index_of(const char* interface) = 0;
  // 1 when the interface is up, 0 when it is down.
  virtual int is_up(int fd, const char* interface) = 0;

  // A raw CAN socket, non-blocking.
  virtual int open() = 0;
  virtual void close(int fd) = 0;
  virtual int set_option(int fd, int level, int option, const void* value, std::size_t bytes) = 0;
  virtual int bind(int fd, int index) = 0;

  // 0, or -EAGAIN when there is none.
  virtual int receive(int fd, CanDatagram& out) = 0;
  // Waits for a frame. poll()'s events, 0 after `timeout` or a signal.
  virtual int poll(int fd, Duration timeout) = 0;

  virtual Time now() = 0;  // CLOCK_MONOTONIC
  virtual CanClocks clocks() = 0;
};

// The real one. Stateless; any thread.
CanIo& kernel_can_io();

}  // namespace zenith
