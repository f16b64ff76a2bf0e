#pragma once
// Local (AF_UNIX) sockets by which programs of one computer find each other under a path. For
// threads without deadlines.

#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

// Where a relative path lies: RUNTIME_DIRECTORY, or for a person XDG_RUNTIME_DIR, or /tmp.
std::string runtime_path(const std::string& path);

// The paths at which a daemon's socket of this name may be, in the order in which they are tried:
// an absolute one alone; else in this person's runtime folder, and in a service's.
std::vector<std::string> runtime_paths(const std::string& socket);

// A listening, non-blocking socket of `type` (SOCK_STREAM, SOCK_SEQPACKET), whose file gets
// `permissions` before anybody can connect. A file that nobody listens on any more is replaced;
// one that somebody listens on is an error.
Result<UniqueFd> listen_local(const std::string& path, int type, unsigned permissions, int backlog);

// A connected, non-blocking socket. `error` is errno when there is none.
UniqueFd connect_local(const std::string& path, int type, int& error);

}  // namespace zenith
