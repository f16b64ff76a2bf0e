#include "platform/daemon/telemetry_socket.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace zenith {

Status TelemetrySocket::open(const std::string& path) {
  close();
  constexpr unsigned kOwnerAndGroup = 0660;  // the service's group may read
  auto made = listen_local(path, SOCK_SEQPACKET, kOwnerAndGroup, static_cast<int>(kReaders));
  if (!made) return Error{"telemetry socket " + path + ": " + made.error().message};
  listener_ = std::move(*made);
  return {};
}

void TelemetrySocket::close() {
  listener_.close();
  for (Reader& reader : readers_) reader = {};
}

std::size_t TelemetrySocket::accept(std::string_view hello) {
  std::size_t count = 0;
  for (int i = 0; i < kAcceptsAtOnce && listener_.is_open(); ++i) {
    UniqueFd fd(::accept4(listener_.fd(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!fd.is_open()) break;
    ucred peer = {};
    socklen_t size = sizeof(peer);
    if (::getsockopt(fd.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) continue;
    Reader* reader = place_for(peer.uid);
    if (reader == nullptr) continue;  // turned away
    *reader = {std::move(fd), peer.uid, {}, {}};
    send_to(*reader, hello);
    ++count;
  }
  return count;
}

TelemetrySocket::Reader* TelemetrySocket::place_for(uid_t user) {
  const auto free = std::find_if(readers_.begin(), readers_.end(),
                                 [](const Reader& reader) { return !reader.fd.is_open(); });
  if (free == readers_.end()) return nullptr;
  if (user == 0 || user == ::geteuid()) return free;
  const auto of_user = std::count_if(
      readers_.begin(), readers_.end(),
      [user](const Reader& reader) { return reader.fd.is_open() && reader.user == user; });
  return static_cast<std::size_t>(of_user) < kReadersOfOne ? free : nullptr;
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

// Readers that are equally far share the lines that were made for one of them.
void TelemetrySocket::send_maps(const MapLines& maps, const MapLines::NameOf& name_of) {
  MapBatch batch;
  bool made = false;
  MapPlace made_for;
  for (Reader& reader : readers_) {
    if (!reader.fd.is_open()) continue;
    if (!made || !(made_for == reader.place)) {
      maps.next(reader.place, name_of, batch);
      made = true;
      made_for = reader.place;
    }
    if (batch.is_too_far_behind) {
      reader = {};
      continue;
    }
    bool all = true;
    for (const std::string& line : batch.lines) {
      all = send_to(reader, line);
      if (!all) break;
    }
    if (all) reader.place = batch.end;
  }
}

bool TelemetrySocket::send_to(Reader& reader, std::string_view line) {
  if (line.empty()) return true;
  ssize_t sent = 0;
  do {
    sent = ::send(reader.fd.get(), line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent >= 0) return true;
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
    ++dropped_;
  } else {
    reader = {};
  }
  return false;
}

std::size_t TelemetrySocket::readers() const {
  return static_cast<std::size_t>(std::count_if(
      readers_.begin(), readers_.end(), [](const Reader& reader) { return reader.fd.is_open(); }));
}

}  // namespace zenith
