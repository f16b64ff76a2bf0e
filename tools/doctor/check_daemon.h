#pragma once
// Checks of the running daemon, by what it tells on its telemetry socket (docs/daemon.md).

#include <string>
#include <vector>

#include "platform/base/time.h"
#include "platform/daemon/config.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/machine_files.h"

namespace zenith::tools {

struct DaemonFacts {
  bool running = false;
  std::string path;                // of the socket that answered, or that is expected
  std::string problem;             // why it cannot be asked, though it seems to be there
  bool untrusted = false;          // the problem: somebody listens who is not to be believed
  int pid = 0;                     // 0: unknown
  std::vector<std::string> lines;  // of JSON, one of each type at least when it is well
};

// Listens until a line of each type that is told once a second has come, at most `patience`.
DaemonFacts ask_daemon(const DaemonConfig& config, Duration patience);

Findings check_daemon(const DaemonFacts& facts);

}  // namespace zenith::tools
