#pragma once
// An open V4L2 device, and how one is found by name.

#include <string>
#include <utility>
#include <vector>

#include "drivers/camera/v4l2_io.h"
#include "drivers/camera/v4l2_offer.h"
#include "platform/base/result.h"

namespace zenith {

// Owns the file descriptor. `io` must outlive it.
class V4l2Device {
 public:
  V4l2Device() = default;
  V4l2Device(V4l2Io& io, int fd) : io_(&io), fd_(fd) {}
  V4l2Device(V4l2Device&& other) noexcept : io_(other.io_), fd_(std::exchange(other.fd_, -1)) {}
  V4l2Device& operator=(V4l2Device&& other) noexcept {
    if (this != &other) {
      close();
      io_ = other.io_;
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~V4l2Device() { close(); }

  bool is_open() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  V4l2Io& io() const { return *io_; }
  // 0 or more, or -errno.
  int control(unsigned long request, void* argument) const {
    return io_->control(fd_, request, argument);
  }
  void close() {
    if (fd_ >= 0) io_->close(std::exchange(fd_, -1));
  }

 private:
  V4l2Io* io_ = nullptr;
  int fd_ = -1;
};

// The error says what to do about a missing file, missing rights or a busy device.
Result<V4l2Device> open_v4l2_device(V4l2Io& io, const std::string& path);

// Who the device is and what it can do; formats stay empty.
Result<V4l2Offer> read_identity(const V4l2Device& device, const std::string& path);

// The path of the device that V4l2Settings::device names. A "name:" or "bus:" must fit devices that
// capture, all of one piece of hardware; the first of its nodes is taken.
Result<std::string> find_v4l2_device(V4l2Io& io, const std::string& device);

}  // namespace zenith
