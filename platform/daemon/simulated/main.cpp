// zenithd-sim: zenithd with a simulated or replayed camera and CAN bus, for whoever has no robot.

#include "platform/daemon/daemon.h"
#include "platform/daemon/simulated/simulated_devices.h"

int main(int argc, char** argv) {
  return zenith::daemon_main(argc, argv, zenith::make_any_devices);
}
