#pragma once
// A daemon's telemetry socket without a daemon: tells what the test says.

#include <sys/socket.h>

#include <string>

#include <nlohmann/json.hpp>

#include "platform/linux/local_socket.h"
#include "platform/linux/unique_fd.h"
#include "tests/system/process.h"

namespace zenith {

class ToldDaemon {
 public:
  explicit ToldDaemon(std::string path) : path_(std::move(path)) {}

  // Listens, and waits for the reader.
  bool wait_for_reader(double limit_s) {
    constexpr unsigned kOwner = 0600;
    auto made = listen_local(path_, SOCK_SEQPACKET, kOwner, 1);
    if (!made) return false;
    listener_ = std::move(*made);
    return wait_until(limit_s, [&] {
      reader_ = UniqueFd(::accept4(listener_.fd(), nullptr, nullptr, SOCK_CLOEXEC));
      return reader_.is_open();
    });
  }
  void say(const nlohmann::json& line) { say_text(line.dump()); }
  // As it is, with an end of line.
  void say_text(const std::string& line) {
    const std::string text = line + "\n";
    (void)::send(reader_.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }
  void leave() {
    reader_.reset();
    listener_.close();
  }
  const std::string& path() const { return path_; }

 private:
  const std::string path_;
  LocalListener listener_;
  UniqueFd reader_;
};

}  // namespace zenith
