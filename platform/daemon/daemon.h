#pragma once
// zenithd: its threads and how they hang together.
//
//   perception    camera, CAN bus, Slam::step()       SCHED_FIFO when permitted; perception.h
//   cooperation   the peers                           cooperation.h
//   keeper        opens devices, again and again      device_keeper.h
//   map           writes checkpoints                  map_keeper.h
//   tap           what a recorder gets                tap/tap_server.h
//   main          signals, log, lights, telemetry     housekeeping.h
//
// How they start and end: running_daemon.h.
//
// All memory of the perception thread is taken, and the service manager told READY, before its
// first frame; that a device is missing does not hold READY back.

#include <filesystem>

#include "platform/daemon/config.h"
#include "platform/daemon/devices.h"

namespace zenith {

class Signals;

// Until SIGTERM or SIGINT; returns the exit code. `signals` is open, and no thread was started.
int run_daemon(const DaemonConfig& config, const std::filesystem::path& file,
               MakeDevices make_devices, Signals& signals);

// What a program around run_daemon() needs: arguments, --help, --check and so on.
int daemon_main(int argc, char** argv, MakeDevices make_devices);

}  // namespace zenith
