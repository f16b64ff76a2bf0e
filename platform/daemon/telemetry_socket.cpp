#include "platform/daemon/telemetry_socket.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "platform/linux/local_socket.h"

namespace zenith {
Status TelemetrySocket::open(const std::string& path) {
  close();
  constexpr unsigned kOwnerAndGroup = 0660;  // the service's group may read
  auto made = listen_local(path, SOCK_SEQPACKET, kOwnerAndGroup, static_cast<int>(kReaders));
  if (!made) return Error{"telemetry socket " + path + ": " + made.error().message};
  path_ = path;
  listener_ = std::move(*made);
  return {};
}

void TelemetrySocket::close() {
  listener_.reset();
  for (Reader& reader : readers_) reader = {};
  if (!path_.empty()) ::unlink(path_.c_str());
  path_.clear();
}

std::size_t TelemetrySocket::accept(std::string_view hello) {
  std::size_t count = 0;
  while (listener_.is_open()) {
    UniqueFd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!fd.is_open()) break;
    const auto place = std::find_if(readers_.begin(), readers_.end(),
                                    [](const Reader& reader) { return !reader.fd.is_open(); });
    if (place == readers_.end()) continue;  // turned away
    *place = {std::move(fd), {}};
    send_to(*place, hello);
    ++count;
  }
  return count;
}

void TelemetrySocket::send(std::string_view line) {
  for (Reader& reader : readers_) {
    if (reader.fd.is_open()) send_to(reader, line);
  }
}

bool TelemetrySocket::take_requests(Time now) {
  constexpr std::string_view kPicture = "picture";
  bool any = false;
  for (Reader& reader : readers_) {
    if (!reader.fd.is_open()) continue;
    std::array<char, 64> text;
    constexpr int kMost = 4;  // who talks more waits for the next turn
    for (int i = 0; i < kMost; ++i) {
      const ssize_t size = ::recv(reader.fd.get(), text.data(), text.size(), MSG_DONTWAIT);
      if (size <= 0) break;
      const std::string_view said(text.data(), static_cast<std::size_t>(size));
      if (said.substr(0, kPicture.size()) == kPicture) reader.looks_until = now + kLookLasts;
    }
    any = any || now < reader.looks_until;
  }
  return any;
}

void TelemetrySocket::send_to_lookers(std::string_view line, Time now) {
  for (Reader& reader : readers_) {
    if (reader.fd.is_open() && now < reader.looks_until) send_to(reader, line);
  }
}

void TelemetrySocket::send_to(Reader& reader, std::string_view line) {
  if (line.empty()) return;
  ssize_t sent = 0;
  do {
    sent = ::send(reader.fd.get(), line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent >= 0) return;
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
    ++dropped_;
  } else {
    reader = {};
  }
}

std::size_t TelemetrySocket::readers() const {
  return static_cast<std::size_t>(std::count_if(
      readers_.begin(), readers_.end(), [](const Reader& reader) { return reader.fd.is_open(); }));
}

}  // namespace zenith
