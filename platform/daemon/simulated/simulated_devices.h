#pragma once
// The devices of zenithd-sim: simulated, replayed, or real ones.

#include "platform/base/result.h"
#include "platform/daemon/config.h"
#include "platform/daemon/devices.h"

namespace zenith {

// As camera.driver says.
Result<Devices> make_any_devices(const DaemonConfig& config);

// Of a robot that drives through a made-up building.
Result<Devices> make_simulated_devices(const DaemonConfig& config);
// Of a recording, whose lens, mount, wheels and codec stand in for the configuration's.
Result<Devices> make_replayed_devices(const DaemonConfig& config);

}  // namespace zenith
