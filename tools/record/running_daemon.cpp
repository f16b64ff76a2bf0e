#include "tools/record/running_daemon.h"

#include <sys/socket.h>

#include <cerrno>

#include "platform/linux/local_socket.h"
#include "tools/record/source.h"

namespace zenith::tools {
namespace {

bool listens(const std::string& path, int type) {
  const LocalConnection connection = connect_local(path, type);
  // Full, or not for us: a daemon is there all the same. One that is not trusted is none.
  return connection.is_open() || (!connection.absent() && connection.error != EPERM);
}

}  // namespace

std::string find_running_daemon(const DaemonConfig& config) {
  // Telemetry first: a recorder's place may be taken, a reader's may not.
  if (config.telemetry.enabled) {
    for (const std::string& path : runtime_paths(config.telemetry.socket)) {
      if (listens(path, SOCK_SEQPACKET)) return path;
    }
  }
  if (config.record.enabled) {
    for (const std::string& path : runtime_paths(config.record.socket)) {
      if (listens(path, SOCK_STREAM)) return path;
    }
  }
  return {};
}

}  // namespace zenith::tools
