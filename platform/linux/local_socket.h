#pragma once
// Local (AF_UNIX) sockets by which programs of one computer find each other under a path, and whom
// a program believes there: root, the service's user `zenith`, and the user who runs it. Folders in
// which anybody may make a file, such as /tmp, are never looked into.
//
// For threads without deadlines.

#include <sys/types.h>

#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/lock_file.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

// Where a daemon makes its socket: an absolute path as it is; a relative one in the first of these
// that there is: RUNTIME_DIRECTORY, XDG_RUNTIME_DIR, /run/user/UID, for root /run/zenith. An error
// where a person has none of them: it says what to set.
Result<std::string> runtime_path(const std::string& path);

// The paths at which a daemon's socket of this name may be, in the order in which they are tried:
// an absolute one alone; else in this person's runtime folder, and in the service's.
std::vector<std::string> runtime_paths(const std::string& socket);

// A listening, non-blocking socket, which removes its file at the end. As long as it is open no
// other listen_local() gets the same path.
class LocalListener {
 public:
  LocalListener() = default;
  LocalListener(LocalListener&& other) = default;
  LocalListener& operator=(LocalListener&& other) noexcept;
  ~LocalListener() { close(); }

  int fd() const { return fd_.get(); }
  bool is_open() const { return fd_.is_open(); }
  const std::string& path() const { return path_; }
  // A file that somebody has put into its place meanwhile stays.
  void close();

 private:
  friend Result<LocalListener> listen_local(const std::string&, int, unsigned, int);

  std::string path_;
  UniqueFd fd_;
  LockFile lock_;
  dev_t device_ = 0;  // of the socket's file
  ino_t inode_ = 0;
};

// `type`: SOCK_STREAM, SOCK_SEQPACKET. The file never has more rights than `permissions`. A file
// that nobody listens on any more is replaced. Errors: somebody listens there or may do so, and a
// folder in which users other than root, zenith and this one could exchange the socket.
Result<LocalListener> listen_local(const std::string& path, int type, unsigned permissions,
                                   int backlog);

struct LocalConnection {
  UniqueFd fd;      // non-blocking; open only where a trusted user listens
  int error = 0;    // errno; EPERM: found, and not trusted
  std::string why;  // there is none, for a person; names whom the socket belongs to
  pid_t pid = 0;    // of who listens

  bool is_open() const { return fd.is_open(); }
  // Nobody listens there.
  bool absent() const;
};

// Every client's way to a daemon's socket. Both who listens and who may change the folder of the
// socket must be root, zenith or this user.
LocalConnection connect_local(const std::string& path, int type);

}  // namespace zenith
