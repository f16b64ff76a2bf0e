#pragma once
// Checks of the computer itself: what the kernel grants a realtime program, the clock, heat, power
// and the disk. All read files below a root that tests replace, or judge plain numbers.

#include <cstdint>
#include <string>

#include "platform/daemon/config.h"
#include "platform/linux/realtime.h"
#include "platform/storage/folder_lock.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/machine_files.h"

namespace zenith::tools {

// `service`: limits were read of the running daemon, and not of this shell.
struct LimitFacts {
  RealtimeLimits limits;
  std::string whose;  // "this shell", "zenithd (pid 812)"
  bool is_root = false;
};

Finding check_fifo(const RealtimeConfig& config, const LimitFacts& facts);
Finding check_locked_memory(const RealtimeConfig& config, const LimitFacts& facts);
Finding check_cpu_dma_latency(const RealtimeConfig& config, const MachineFiles& files);
Finding check_governor(const MachineFiles& files);
Finding check_preemption(const MachineFiles& files);
Finding check_rt_throttling(const RealtimeConfig& config, const MachineFiles& files);

// Of another process, by /proc/PID/limits and status; false when they cannot be read.
bool read_process_limits(const MachineFiles& files, int pid, LimitFacts& facts);

struct ClockFacts {
  bool readable = false;
  bool synchronised = false;
  double error_s = 0.0;  // estimated, of the kernel's clock
  bool monotonic_rises = true;
};
ClockFacts read_clock();
Finding check_clock_source(const MachineFiles& files);
Finding check_clock_sync(const ClockFacts& facts);
Finding check_monotonic(const ClockFacts& facts);

Finding check_temperature(const MachineFiles& files);
Finding check_power(const MachineFiles& files);
// The folder of the stored map, as the configuration names it; `robot`: whose map it should be,
// `daemon_pid`: of the running daemon that was asked, 0: none.
Finding check_map_folder(const std::string& folder, const storage::FolderFacts& facts,
                         const std::string& robot, int daemon_pid);
Finding check_disk(const std::string& folder, double free_mb);
// Free for this user, MB; negative when the folder cannot be asked.
double free_disk_mb(const std::string& folder);

}  // namespace zenith::tools
