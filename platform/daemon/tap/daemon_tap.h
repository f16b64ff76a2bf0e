#pragma once
// The tap of one daemon: what a configuration makes of it.

#include <memory>

#include "platform/daemon/config.h"
#include "platform/daemon/devices.h"
#include "platform/daemon/tap/tap.h"
#include "platform/daemon/tap/tap_server.h"

namespace zenith::tap {

// What a recorder is told of the robot. Reads the DBC file, when there is one.
Hello describe_robot(const DaemonConfig& config, const Devices& devices);

struct DaemonTap {
  std::unique_ptr<Tap> tap;  // both null when record.enabled is false
  std::unique_ptr<TapServer> server;
};
// Takes all memory. A socket that cannot be opened is logged; the daemon goes on without.
DaemonTap make_daemon_tap(const DaemonConfig& config, const Devices& devices);

}  // namespace zenith::tap
