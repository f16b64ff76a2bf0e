#pragma once
// The daemon while it runs: what its threads share, the threads, and the end.
//
// The end comes once, whatever way run() is left:
//
//   all threads are told; perception and cooperation hand over their last landmarks
//   the thread of the map writes the last checkpoint: waited for kCheckpointLimit, and the service
//     manager is asked for as much time as that takes
//   devices are closed, on a thread of their own: a driver may hang in open() and in close()
//
// No device costs a checkpoint or the exit code: a thread that hangs in a driver is left behind,
// which the log says.

#include <functional>
#include <memory>

#include "platform/daemon/cooperation.h"
#include "platform/daemon/daemon_threads.h"
#include "platform/daemon/device_keeper.h"
#include "platform/daemon/housekeeping.h"
#include "platform/daemon/map_keeper.h"
#include "platform/daemon/perception.h"
#include "platform/daemon/radio_link.h"
#include "platform/daemon/tap/daemon_tap.h"
#include "platform/linux/realtime.h"
#include "platform/linux/service_notify.h"

namespace zenith {

class RunningDaemon {
 public:
  // Perception and cooperation, and everything at the end, end in some milliseconds.
  static constexpr Duration kThreadLimit = {4'000'000'000};
  // A card that is worn out takes seconds for each of the few files of a checkpoint.
  static constexpr Duration kCheckpointLimit = {60'000'000'000};

  // All must outlive it. Takes all memory of the algorithm. `maps`: null when no map is kept.
  RunningDaemon(const DaemonConfig& config, const std::filesystem::path& file, Devices& devices,
                ServiceNotify& notify, storage::Folder* maps);
  ~RunningDaemon();
  RunningDaemon(const RunningDaemon&) = delete;
  RunningDaemon& operator=(const RunningDaemon&) = delete;

  // Once: starts, calls `serve`, ends. Returns the exit code: serve's, or 1 for what failed. Does
  // not return, but ends the process with that code, when a thread has to be left behind.
  int run(const std::function<int()>& serve);

  // --- for `serve`
  Housekeeping& housekeeping() { return *housekeeping_; }
  // Something that only a new start mends: then `serve` returns 1.
  bool failed() const;

 private:
  bool start_threads();
  bool start_perception(Report& report);
  void keep_map(const std::atomic<bool>& stop);
  int end(int code);
  bool wait_until(const std::function<bool()>& holds, Duration limit);
  bool last_checkpoint();
  bool close_devices();

  const DaemonConfig& config_;
  Devices& devices_;
  ServiceNotify& notify_;
  const std::unique_ptr<Exchange> exchange_;
  const tap::DaemonTap tap_;
  const std::unique_ptr<Perception> perception_;
  std::unique_ptr<RadioLink> link_;
  std::unique_ptr<MapKeeper> map_keeper_;
  std::unique_ptr<Cooperation> cooperation_;
  DeviceKeeper device_keeper_;
  CpuDmaLatency awake_;
  std::unique_ptr<Housekeeping> housekeeping_;
  std::atomic<bool> told_all_ = false;  // the map's thread has heard all that there is
  bool has_ended_ = false;
  DaemonThreads threads_;  // the first to go
};

}  // namespace zenith
