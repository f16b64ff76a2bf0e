#pragma once
// CPU time of this thread, for benchmarks that must leave part of an iteration out. Other
// processes on the machine do not count, but for the caches that they take.

#include <ctime>

#include <benchmark/benchmark.h>

namespace zenith::bench {

inline double thread_seconds() {
  std::timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The iteration's time is what `work` takes. For benchmarks with UseManualTime().
template <typename Work>
void time_iteration(benchmark::State& state, const Work& work) {
  const double start = thread_seconds();
  work();
  state.SetIterationTime(thread_seconds() - start);
}

}  // namespace zenith::bench
