#include "platform/linux/clock_reading.h"

#include <sys/timex.h>

#include <ctime>

#include "platform/linux/clock.h"

namespace zenith {

ClockReading read_clocks() {
  ClockReading out;
  timespec boot = {};
  out.wall = system_clock_offset();
  const Time before = monotonic_now();
  clock_gettime(CLOCK_BOOTTIME, &boot);
  out.monotonic = monotonic_now();
  // Of a board that never slept the difference is that of the calls.
  const std::int64_t boot_ns = boot.tv_sec * std::int64_t{1'000'000'000} + boot.tv_nsec;
  const std::int64_t between_ns = (out.monotonic - before).ns / 2;
  out.suspended = {boot_ns - before.ns - between_ns};
  if (out.suspended < Duration{between_ns + 1}) out.suspended = {0};
  timex kernel = {};
  const int state = adjtimex(&kernel);  // modes 0: reads
  out.synchronised = state != -1 && state != TIME_ERROR && (kernel.status & STA_UNSYNC) == 0;
  return out;
}

}  // namespace zenith
