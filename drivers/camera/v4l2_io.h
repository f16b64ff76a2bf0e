#pragma once
// The few system calls that the V4L2 camera makes, so that tests can stand in for the kernel.
//
// Results below zero are -errno. poll(), control(), now() are called by the realtime thread.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/time.h"

namespace zenith {

class V4l2Io {
 public:
  V4l2Io() = default;
  V4l2Io(const V4l2Io&) = delete;
  V4l2Io& operator=(const V4l2Io&) = delete;
  virtual ~V4l2Io() = default;

  // "/dev/video0", "/dev/video2", ... in the order of their numbers.
  virtual std::vector<std::string> list() = 0;

  // Non-blocking, for reading and writing. A file descriptor, or -errno.
  virtual int open(const char* path) = 0;
  virtual void close(int fd) = 0;

  // ioctl, repeated when a signal interrupts it. 0 or more, or -errno.
  virtual int control(int fd, unsigned long request, void* argument) = 0;

  // Shared memory of one buffer; null when it cannot be had.
  virtual void* map(int fd, std::size_t length, std::int64_t offset) = 0;
  virtual void unmap(void* start, std::size_t length) = 0;

  // Waits for a frame. poll()'s events, 0 after `timeout` or a signal, or -errno.
  virtual int poll(int fd, Duration timeout) = 0;

  virtual Time now() = 0;  // CLOCK_MONOTONIC
};

// The real one. Stateless; any thread.
V4l2Io& kernel_v4l2_io();

}  // namespace zenith
