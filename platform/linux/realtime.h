#pragma once
// What a thread with deadlines asks of the kernel. Nothing here is fatal: what the kernel does not
// grant becomes one line for a person in a Report (what, why, what to do), and the program goes on
// without it.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

using Report = std::vector<std::string>;

// Keeps all present and future memory of the process in RAM. Call before threads are started. From
// then on every new stack and buffer counts against RLIMIT_MEMLOCK. False: not locked.
bool lock_memory(Report& report);

// Fixes how the C library's allocator gets memory: one heap for all threads, that only grows. What
// is freed stays in the process, locked and in its page tables, for the next one that asks; no
// thread causes page faults of another by giving memory back. First of all in main().
void pin_heap();

// A thread of a realtime priority that computes for so long without waiting once never will: it
// keeps its CPU from everything else. 3 s are some thirty times the longest step of a frame on the
// slowest board, and end well before a watchdog of 10 s.
inline constexpr Duration kRealtimeLimit = {3'000'000'000};
// Sets RLIMIT_RTTIME of the process. At `limit` (SIGXCPU) the thread loses its priority, so that
// the rest of the program can end in good order, and realtime_overrun() is true; at twice that the
// kernel ends the process. False: not granted.
bool limit_realtime(Duration limit, Report& report);
bool realtime_overrun();

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
