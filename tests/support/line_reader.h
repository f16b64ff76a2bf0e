#pragma once
// Reads the telemetry socket of a daemon.

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "platform/base/time.h"
#include "tests/support/patience.h"

namespace zenith {

class LineReader {
 public:
  explicit LineReader(const std::string& path) { connect(path); }
  ~LineReader() { ::close(fd_); }
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  // Once more, when nobody listened before.
  void connect(const std::string& path) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    connected_ = ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    ended_ = false;
  }

  bool connected() const { return connected_; }
  // The daemon has left.
  bool ended() const { return ended_; }

  // To the daemon.
  void say(const std::string& text) { (void)::send(fd_, text.data(), text.size(), MSG_NOSIGNAL); }

  // The next line; empty when there is none in time, or the daemon has left.
  std::string next(Duration limit = kPatience) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    timeval wait = {limit.ns / kSecond_ns, limit.ns % kSecond_ns / 1000};
    if (limit.ns < 1000) wait = {0, 1};  // zero would wait for ever
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
    std::array<char, 8192> text;
    const ssize_t length = ::recv(fd_, text.data(), text.size(), 0);
    ended_ = length == 0 || (length < 0 && errno != EAGAIN && errno != EINTR);
    return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
  }

 private:
  int fd_ = -1;
  bool connected_ = false;
  bool ended_ = false;
};

}  // namespace zenith
