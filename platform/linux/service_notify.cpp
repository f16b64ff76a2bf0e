#include "platform/linux/service_notify.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxStatusBytes = 200;

std::optional<std::int64_t> positive_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value <= 0) return std::nullopt;
  return value;
}

// Watched are we alone when WATCHDOG_PID names us or is not there.
Result<std::optional<Duration>> watchdog_from_environment() {
  const char* interval = std::getenv("WATCHDOG_USEC");
  if (interval == nullptr) return std::optional<Duration>();
  const char* pid = std::getenv("WATCHDOG_PID");
  if (pid != nullptr) {
    const std::optional<std::int64_t> number = positive_number(pid);
    if (!number) {
      return Error{std::string("WATCHDOG_PID: expected a process id, found \"") + pid +
                   "\"; it is the service manager's to set"};
    }
    if (*number != getpid()) return std::optional<Duration>();
  }
  const std::optional<std::int64_t> interval_us = positive_number(interval);
  if (!interval_us || *interval_us > INT64_MAX / 1000) {
    return Error{std::string("WATCHDOG_USEC: expected microseconds, found \"") + interval +
                 "\"; it is the service manager's to set (WatchdogSec=)"};
  }
  return std::optional<Duration>(Duration{*interval_us * 1000});
}

// "/path", or "@name" for the abstract namespace, where the name has no ending zero.
Result<UniqueFd> connect_to(std::string_view name) {
  const auto failed = [name](const std::string& why) {
    return Error{"NOTIFY_SOCKET=" + std::string(name) + ": " + why +
                 "; the service manager is not told how we are"};
  };
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (name.size() < 2 || (name[0] != '/' && name[0] != '@')) {
    return failed("expected a path or an abstract socket (@name)");
  }
  if (name.size() >= sizeof(address.sun_path)) return failed("too long for a socket");
  std::memcpy(address.sun_path, name.data(), name.size());
  const bool abstract = name[0] == '@';
  if (abstract) address.sun_path[0] = '\0';
  const auto length =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size() + (abstract ? 0 : 1));
  UniqueFd fd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!fd.is_open() ||
      ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), length) != 0) {
    return failed(errno_text(errno));
  }
  return fd;
}

}  // namespace

Status ServiceNotify::open_from_environment() {
  socket_.reset();
  watchdog_interval_.reset();
  const char* name = std::getenv("NOTIFY_SOCKET");
  if (name == nullptr) return {};
  const auto interval = watchdog_from_environment();
  if (!interval) return interval.error();
  auto socket = connect_to(name);
  if (!socket) return socket.error();
  socket_ = std::move(*socket);
  watchdog_interval_ = *interval;
  return {};
}

Status ServiceNotify::ready() {
  return send("READY=1");
}

Status ServiceNotify::reloading(Time now) {
  std::array<char, 80> text;
  const int length = std::snprintf(text.data(), text.size(), "RELOADING=1\nMONOTONIC_USEC=%lld",
                                   static_cast<long long>(now.ns / 1000));
  return send({text.data(), static_cast<std::size_t>(length)});
}

Status ServiceNotify::stopping() {
  return send("STOPPING=1");
}

Status ServiceNotify::extend_timeout(Duration time) {
  std::array<char, 64> text;
  const int length = std::snprintf(text.data(), text.size(), "EXTEND_TIMEOUT_USEC=%lld",
                                   static_cast<long long>(time.ns / 1000));
  return send({text.data(), static_cast<std::size_t>(length)});
}

Status ServiceNotify::watchdog() {
  return send("WATCHDOG=1");
}

Status ServiceNotify::status(std::string_view text) {
  constexpr std::string_view kKey = "STATUS=";
  std::array<char, kKey.size() + kMaxStatusBytes> message;
  std::size_t length = kKey.copy(message.data(), kKey.size());
  for (const char c : text.substr(0, kMaxStatusBytes)) message[length++] = c == '\n' ? ' ' : c;
  return send({message.data(), length});
}

Status ServiceNotify::send(std::string_view message) {
  if (!socket_.is_open()) return {};
  ssize_t sent = 0;
  do {
    sent = ::send(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  } while (sent < 0 && errno == EINTR);
  if (sent == static_cast<ssize_t>(message.size())) return {};
  return Error{"the service manager was not told \"" + std::string(message) +
               "\": " + errno_text(errno)};
}

}  // namespace zenith
