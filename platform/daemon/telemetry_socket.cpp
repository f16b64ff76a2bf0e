#include "platform/daemon/telemetry_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

UniqueFd make_socket() {
  return UniqueFd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

bool address_of(const std::string& path, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, path.data(), path.size());
  return true;
}

bool somebody_listens(const sockaddr_un& address) {
  const UniqueFd probe = make_socket();
  return probe.is_open() &&
         ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

bool is_socket(const std::string& path) {
  struct stat file = {};
  return ::lstat(path.c_str(), &file) == 0 && S_ISSOCK(file.st_mode);
}

}  // namespace

std::string runtime_path(const std::string& path) {
  if (path.empty() || path[0] == '/') return path;
  for (const char* name : {"RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"}) {
    const char* folder = std::getenv(name);
    if (folder == nullptr || *folder == '\0') continue;
    const std::string first(folder, std::strcspn(folder, ":"));  // systemd lists several so
    return first + "/" + path;
  }
  return "/tmp/" + path;
}

Status TelemetrySocket::open(const std::string& path) {
  close();
  const auto failed = [&path](const std::string& why) {
    return Error{"telemetry socket " + path + ": " + why};
  };
  sockaddr_un address = {};
  if (!address_of(path, address)) return failed("the path is too long for a socket");
  if (is_socket(path)) {
    if (somebody_listens(address)) {
      return failed("another program listens there; give each daemon a socket of its own");
    }
    ::unlink(path.c_str());
  }
  UniqueFd fd = make_socket();
  if (!fd.is_open() ||
      ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return failed(errno_text(errno) +
                  "; the folder must be there and writable "
                  "(RuntimeDirectory= in the unit)");
  }
  path_ = path;
  ::chmod(path.c_str(), 0660);  // the service's group may read
  if (::listen(fd.get(), static_cast<int>(kReaders)) != 0) {
    const int error = errno;
    close();
    return failed(errno_text(error));
  }
  listener_ = std::move(fd);
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
