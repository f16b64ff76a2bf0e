#pragma once

#include <string>

#include "platform/daemon/config.h"

namespace zenith::tools {

// The path of a socket of this configuration at which a daemon listens; empty when none does.
// Connecting disturbs no daemon.
std::string find_running_daemon(const DaemonConfig& config);

}  // namespace zenith::tools
