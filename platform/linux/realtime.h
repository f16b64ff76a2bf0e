#pragma once
// What a thread with deadlines asks of the kernel. Nothing here is fatal: what the kernel does not
// grant becomes one line for a person in a Report (what, why, what to do), and the program goes on
// without it.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/linux/unique_fd.h"

namespace zenith {

using Report = std::vector<std::string>;

// Keeps all present and future memory of the process in RAM. Call before threads are started. From
// then on every new stack and buffer counts against RLIMIT_MEMLOCK. False: not locked.
bool lock_memory(Report& report);

// Touches that much of the calling thread's stack, so that it does not fault later.
void prefault_stack(std::size_t bytes);

// Holds /dev/cpu_dma_latency at 0: the CPUs do not enter deep sleep states, from which they take
// long to wake. For as long as the object lives; costs power.
class CpuDmaLatency {
 public:
  // False when not granted.
  bool hold(Report& report, const char* device = "/dev/cpu_dma_latency");
  bool held() const { return fd_.is_open(); }

 private:
  UniqueFd fd_;
};

struct PageFaults {
  std::uint64_t minor = 0;
  std::uint64_t major = 0;  // had to read from a disk
};
// Of the calling thread since its start.
PageFaults thread_page_faults();

struct RealtimeLimits {
  static constexpr std::uint64_t kUnlimited = UINT64_MAX;
  std::uint64_t fifo_priority = 0;  // RLIMIT_RTPRIO; 0: none may be taken
  std::uint64_t locked_bytes = 0;   // RLIMIT_MEMLOCK
};
// Soft limits of the process. Root, or CAP_SYS_NICE and CAP_IPC_LOCK, stand above them.
RealtimeLimits realtime_limits();

}  // namespace zenith
