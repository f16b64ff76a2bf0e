// zenithd: the program that runs on the robot.

#include "platform/daemon/daemon.h"

int main(int argc, char** argv) {
  return zenith::daemon_main(argc, argv, zenith::make_real_devices);
}
