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
  for (UniqueFd& reader : readers_) reader.reset();
  if (!path_.empty()) ::unlink(path_.c_str());
  path_.clear();
}

std::size_t TelemetrySocket::accept(std::string_view hello) {
  std::size_t count = 0;
  while (listener_.is_open()) {
    UniqueFd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!fd.is_open()) break;
    const auto place = std::find_if(readers_.begin(), readers_.end(),
                                    [](const UniqueFd& reader) { return !reader.is_open(); });
    if (place == readers_.end()) continue;  // turned away
    *place = std::move(fd);
    send_to(*place, hello);
    ++count;
  }
  return count;
}

void TelemetrySocket::send(std::string_view line) {
  for (UniqueFd& reader : readers_) {
    if (reader.is_open()) send_to(reader, line);
  }
}

void TelemetrySocket::send_to(UniqueFd& reader, std::string_view line) {
  if (line.empty()) return;
  ssize_t sent = 0;
  do {
    sent = ::send(reader.get(), line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent >= 0) return;
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
    ++dropped_;
  } else {
    reader.reset();
  }
}

std::size_t TelemetrySocket::readers() const {
  return static_cast<std::size_t>(std::count_if(
      readers_.begin(), readers_.end(), [](const UniqueFd& reader) { return reader.is_open(); }));
}

}  // namespace zenith
