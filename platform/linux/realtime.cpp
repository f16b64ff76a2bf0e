#include "platform/linux/realtime.h"

#include <alloca.h>
#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

std::uint64_t soft_limit(__rlimit_resource resource) {
  rlimit limit = {};
  if (getrlimit(resource, &limit) != 0) return 0;
  return limit.rlim_cur == RLIM_INFINITY ? RealtimeLimits::kUnlimited : limit.rlim_cur;
}

std::atomic<bool> overrun = false;
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

// In the thread that took too long.
void lose_priority(int /*signal*/) {
  const int error = errno;
  const sched_param none = {};
  (void)::sched_setscheduler(0, SCHED_OTHER, &none);
  overrun.store(true, std::memory_order_release);
  errno = error;
}

std::string bytes_text(std::uint64_t bytes) {
  if (bytes == RealtimeLimits::kUnlimited) return "unlimited";
  return std::to_string(bytes / 1024) + " KiB";
}

}  // namespace

bool lock_memory(Report& report) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return true;
  const int error = errno;
  report.push_back("memory is not locked in RAM, so a deadline may wait for a page: " +
                   errno_text(error) + ", limit " + bytes_text(realtime_limits().locked_bytes) +
                   "; set LimitMEMLOCK=infinity in the unit, or ulimit -l unlimited");
  return false;
}

void pin_heap() {
#if defined(__GLIBC__)
  ::mallopt(M_ARENA_MAX, 1);
  ::mallopt(M_MMAP_MAX, 0);         // large blocks come from the heap, too, and stay there
  ::mallopt(M_TRIM_THRESHOLD, -1);  // never
#endif
}

bool limit_realtime(Duration limit, Report& report) {
  struct sigaction action = {};
  action.sa_handler = lose_priority;
  action.sa_flags = SA_RESTART;
  rlimit time = {};
  const auto soft = static_cast<rlim_t>(limit.ns / 1000);
  if (::sigaction(SIGXCPU, &action, nullptr) == 0 && ::getrlimit(RLIMIT_RTTIME, &time) == 0) {
    time.rlim_max = std::min<rlim_t>(time.rlim_max, 2 * soft);
    time.rlim_cur = std::min<rlim_t>(time.rlim_max, soft);
    if (::setrlimit(RLIMIT_RTTIME, &time) == 0) return true;
  }
  report.push_back("a realtime thread that never waits is not stopped: RLIMIT_RTTIME: " +
                   errno_text(errno));
  return false;
}

bool realtime_overrun() {
  return overrun.load(std::memory_order_acquire);
}

__attribute__((noinline)) void prefault_stack(std::size_t bytes) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* stack = static_cast<volatile unsigned char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += page) stack[i] = 0;
  if (bytes > 0) stack[bytes - 1] = 0;
}

bool CpuDmaLatency::hold(Report& report, const char* device) {
  fd_.reset(::open(device, O_WRONLY | O_CLOEXEC));
  const std::int32_t latency_us = 0;
  if (fd_.is_open() && ::write(fd_.get(), &latency_us, sizeof(latency_us)) == sizeof(latency_us)) {
    return true;
  }
  const int error = errno;
  fd_.reset();
  report.push_back(std::string("CPUs may sleep deeply and wake late: ") + device + ": " +
                   errno_text(error) +
                   "; give the service's group write access to it (udev rule) and allow it in the "
                   "unit (DeviceAllow=), or run without");
  return false;
}

PageFaults thread_page_faults() {
  rusage usage = {};
  if (getrusage(RUSAGE_THREAD, &usage) != 0) return {};
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt)};
}

RealtimeLimits realtime_limits() {
  return {soft_limit(RLIMIT_RTPRIO), soft_limit(RLIMIT_MEMLOCK)};
}

}  // namespace zenith
