#pragma once
// The account of time, kept by the perception thread and read by others at any moment.
//
// A frame's deadline: its step takes no longer than a frame's period. A missed one is *explained*
// when the thread itself computed for less than the period: the rest of the time the kernel ran
// something else.

#include <atomic>
#include <cstdint>

#include "platform/base/time.h"
#include "platform/linux/latency_histogram.h"

namespace zenith {

struct Deadlines {
  LatencyHistogram wake_up;  // how late the kernel ended a wait of the thread
  LatencyHistogram step;     // of a frame, wall time
  LatencyHistogram compute;  // of this, what the thread itself computed
  LatencyHistogram stolen;   // and the rest
  LatencyHistogram age;      // from the frame's capture to its result

  std::atomic<std::uint64_t> met = 0;
  std::atomic<std::uint64_t> missed = 0;
  std::atomic<std::uint64_t> explained = 0;  // of the missed ones

  // By the perception thread.
  void note(Duration wall, Duration cpu, Duration since_capture, Duration period) {
    step.add(wall);
    compute.add(cpu);
    stolen.add({wall.ns - cpu.ns});
    age.add(since_capture);
    if (wall <= period) {
      bump(met);
      return;
    }
    bump(missed);
    if (cpu <= period) bump(explained);
  }

 private:
  static void bump(std::atomic<std::uint64_t>& count) {
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
};

}  // namespace zenith
