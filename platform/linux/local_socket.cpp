#include "platform/linux/local_socket.h"

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

UniqueFd make_socket(int type) {
  return UniqueFd(::socket(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

bool address_of(const std::string& path, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, path.data(), path.size());
  return true;
}

const sockaddr* plain(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
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

std::vector<std::string> runtime_paths(const std::string& socket) {
  std::vector<std::string> paths = {runtime_path(socket)};
  if (socket.empty() || socket[0] == '/') return paths;
  for (const char* folder : {"/run/zenith/", "/tmp/"}) {
    const std::string path = folder + socket;
    if (std::find(paths.begin(), paths.end(), path) == paths.end()) paths.push_back(path);
  }
  return paths;
}

Result<UniqueFd> listen_local(const std::string& path, int type, unsigned permissions,
                              int backlog) {
  const auto failed = [](const std::string& why) { return Error{why}; };
  sockaddr_un address = {};
  if (!address_of(path, address)) return failed("the path is too long for a socket");
  if (is_socket(path)) {
    int error = 0;
    if (connect_local(path, type, error).is_open()) {
      return failed("another program listens there; give each daemon a socket of its own");
    }
    ::unlink(path.c_str());
  }
  UniqueFd fd = make_socket(type);
  if (!fd.is_open() || ::bind(fd.get(), plain(address), sizeof(address)) != 0) {
    return failed(errno_text(errno) +
                  "; the folder must be there and writable (RuntimeDirectory= in the unit)");
  }
  ::chmod(path.c_str(), permissions);
  if (::listen(fd.get(), backlog) != 0) {
    const int error = errno;
    ::unlink(path.c_str());
    return failed(errno_text(error));
  }
  return fd;
}

UniqueFd connect_local(const std::string& path, int type, int& error) {
  sockaddr_un address = {};
  error = ENAMETOOLONG;
  if (!address_of(path, address)) return UniqueFd();
  UniqueFd fd = make_socket(type);
  error = 0;
  if (fd.is_open() && ::connect(fd.get(), plain(address), sizeof(address)) == 0) return fd;
  error = errno;
  return UniqueFd();
}

}  // namespace zenith
