#include "platform/linux/local_socket.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr const char* kServiceFolder = "/run/zenith";
constexpr const char* kServiceUser = "zenith";
constexpr mode_t kWritableByOthers = S_IWGRP | S_IWOTH;

// --- users ---------------------------------------------------------------------------------------

using NameRoom = std::array<char, 16384>;

bool is_service_user(uid_t user) {
  passwd entry = {};
  passwd* found = nullptr;
  NameRoom room;
  return ::getpwnam_r(kServiceUser, &entry, room.data(), room.size(), &found) == 0 &&
         found != nullptr && entry.pw_uid == user;
}

bool is_trusted(uid_t user) {
  return user == 0 || user == ::geteuid() || is_service_user(user);
}

// "user anna (1000)"
std::string user_text(uid_t user) {
  passwd entry = {};
  passwd* found = nullptr;
  NameRoom room;
  const bool named =
      ::getpwuid_r(user, &entry, room.data(), room.size(), &found) == 0 && found != nullptr;
  const std::string number = std::to_string(user);
  return named ? std::string("user ") + entry.pw_name + " (" + number + ")" : "user " + number;
}

// --- places --------------------------------------------------------------------------------------

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// That only those whom this program trusts can put a file into it.
Status check_folder(const std::string& folder) {
  struct stat info = {};
  if (::stat(folder.c_str(), &info) != 0) return {};  // what is done next says why
  if (!is_trusted(info.st_uid)) {
    return Error{"the folder " + folder + " belongs to " + user_text(info.st_uid) +
                 "; trusted are root, zenith and " + user_text(::geteuid())};
  }
  if ((info.st_mode & kWritableByOthers) != 0) {
    return Error{"others may write to the folder " + folder +
                 ", and put a socket of theirs there; take one of your own, or chmod go-w " +
                 folder};
  }
  return {};
}

bool is_own_folder(const std::string& folder) {
  struct stat info = {};
  return ::lstat(folder.c_str(), &info) == 0 && S_ISDIR(info.st_mode) &&
         info.st_uid == ::geteuid() && (info.st_mode & kWritableByOthers) == 0;
}

// --- sockets -------------------------------------------------------------------------------------

UniqueFd make_socket(int type) {
  return UniqueFd(::socket(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

bool address_of(const std::string& path, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path, path.data(), path.size());
  return true;
}

const sockaddr* plain(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

// Whoever listens. Returns 0, or errno.
int connect_any(const std::string& path, int type, UniqueFd& fd) {
  sockaddr_un address = {};
  if (!address_of(path, address)) return ENAMETOOLONG;
  fd = make_socket(type);
  if (fd.is_open() && ::connect(fd.get(), plain(address), sizeof(address)) == 0) return 0;
  const int error = errno;
  fd.reset();
  return error;
}

bool is_absent(int error) {
  return error == ENOENT || error == ECONNREFUSED || error == ENOTDIR;
}

// A socket at which nobody listens may be replaced, and nothing else. A full queue (EAGAIN), rights
// or another type of socket (EPROTOTYPE) are signs of a living program.
Status check_free(const std::string& path, int type) {
  struct stat file = {};
  if (::lstat(path.c_str(), &file) != 0) {
    return errno == ENOENT ? Status() : Error{errno_text(errno)};
  }
  if (!S_ISSOCK(file.st_mode)) return Error{"something else than a socket is there"};
  UniqueFd fd;
  const int error = connect_any(path, type, fd);
  if (is_absent(error)) return {};
  return Error{"another program listens there" +
               (error == 0 ? std::string() : " (" + errno_text(error) + ")") +
               "; give each daemon a socket of its own"};
}

std::string lock_path(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  return folder + "." + path.substr(folder.size()) + ".lock";
}

// Of programs that begin at the same time one gets it.
Status take_lock(const std::string& path, LockFile& lock) {
  LockFile::Try tried = lock.take(path);
  // Left behind by a daemon that another user ran here. check_free() found that it is gone.
  if (tried.error == EACCES && tried.state == LockFile::State::kFailed &&
      ::unlink(path.c_str()) == 0) {
    tried = lock.take(path);
  }
  switch (tried.state) {
    case LockFile::State::kOurs:
      return {};
    case LockFile::State::kOthers:
      return Error{"another program begins to listen there; give each daemon a socket of its own"};
    case LockFile::State::kUnsupported:
      return Error{path + ": lies on a file system without locks; name a socket elsewhere"};
    case LockFile::State::kFailed:
      break;
  }
  return Error{path + ": " + tried.why +
               "; the folder must be there and writable (RuntimeDirectory= in the unit)"};
}

}  // namespace

Result<std::string> runtime_path(const std::string& path) {
  if (path.empty() || path[0] == '/') return path;
  for (const char* name : {"RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"}) {
    const char* folder = std::getenv(name);
    if (folder == nullptr || *folder == '\0') continue;
    const std::string first(folder, std::strcspn(folder, ":"));  // systemd lists several so
    return first + "/" + path;
  }
  const std::string own = "/run/user/" + std::to_string(::geteuid());
  if (is_own_folder(own)) return own + "/" + path;
  if (::geteuid() == 0) return kServiceFolder + ("/" + path);
  return Error{path + ": there is no folder for it: XDG_RUNTIME_DIR is not set, and " + own +
               " is not there; set XDG_RUNTIME_DIR to a folder of your own (mode 0700), or name "
               "the socket by an absolute path (telemetry.socket, record.socket)"};
}

std::vector<std::string> runtime_paths(const std::string& socket) {
  std::vector<std::string> paths;
  if (auto own = runtime_path(socket)) paths.push_back(std::move(*own));
  if (socket.empty() || socket[0] == '/') return paths;
  const std::string path = kServiceFolder + ("/" + socket);
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) paths.push_back(path);
  return paths;
}

LocalListener& LocalListener::operator=(LocalListener&& other) noexcept {
  if (this == &other) return *this;
  close();
  path_ = std::move(other.path_);
  fd_ = std::move(other.fd_);
  lock_ = std::move(other.lock_);
  device_ = other.device_;
  inode_ = other.inode_;
  return *this;
}

void LocalListener::close() {
  if (!fd_.is_open()) return;
  struct stat there = {};
  if (::lstat(path_.c_str(), &there) == 0 && there.st_dev == device_ && there.st_ino == inode_) {
    ::unlink(path_.c_str());
  }
  fd_.reset();
  lock_.remove();
  path_.clear();
}

Result<LocalListener> listen_local(const std::string& path, int type, unsigned permissions,
                                   int backlog) {
  sockaddr_un address = {};
  if (!address_of(path, address)) return Error{"the path is too long for a socket"};
  const std::string folder = folder_of(path);
  if (folder == kServiceFolder && ::geteuid() == 0) ::mkdir(folder.c_str(), 0755);
  if (const Status safe = check_folder(folder); !safe) return safe.error();
  if (const Status free = check_free(path, type); !free) return free.error();
  LocalListener made;
  if (const Status ours = take_lock(lock_path(path), made.lock_); !ours) return ours.error();
  // Only now nobody else can have begun meanwhile.
  if (const Status free = check_free(path, type); !free) return free.error();
  ::unlink(path.c_str());
  UniqueFd fd = make_socket(type);
  // The file is born with these rights, less those of the umask; nobody can connect before
  // listen().
  const bool bound = fd.is_open() && ::fchmod(fd.get(), permissions) == 0 &&
                     ::bind(fd.get(), plain(address), sizeof(address)) == 0;
  struct stat file = {};
  if (!bound || ::chmod(path.c_str(), permissions) != 0 || ::lstat(path.c_str(), &file) != 0) {
    return Error{errno_text(errno) +
                 "; the folder must be there and writable (RuntimeDirectory= in the unit)"};
  }
  made.path_ = path;
  made.fd_ = std::move(fd);
  made.device_ = file.st_dev;
  made.inode_ = file.st_ino;
  if (::listen(made.fd_.get(), backlog) != 0) return Error{errno_text(errno)};
  return made;
}

bool LocalConnection::absent() const {
  return !is_open() && is_absent(error);
}

LocalConnection connect_local(const std::string& path, int type) {
  LocalConnection made;
  const auto refuse = [&made](int error, std::string why) {
    made.fd.reset();
    made.error = error;
    made.why = std::move(why);
    return std::move(made);
  };
  if (const Status safe = check_folder(folder_of(path)); !safe) {
    return refuse(EPERM, safe.error().message);
  }
  if (const int error = connect_any(path, type, made.fd); error != 0) {
    return refuse(error, errno_text(error));
  }
  ucred peer = {};
  socklen_t size = sizeof(peer);
  if (::getsockopt(made.fd.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return refuse(errno, errno_text(errno));
  }
  made.pid = peer.pid;
  if (is_trusted(peer.uid)) return made;
  return refuse(EPERM, "the socket is one of " + user_text(peer.uid) +
                           "; trusted are root, zenith and " + user_text(::geteuid()));
}

}  // namespace zenith
