// The step's time against the size of the map, with the same landmarks in view: a robot maps a long
// strip of ceiling and then goes to and fro at its end. The end is the same for every size, point
// for point. No pixels: the world of points of the filter's tests.

#include <map>
#include <memory>

#include <benchmark/benchmark.h>

#include "tests/bench/stopwatch.h"
#include "tests/support/strip_rig.h"

namespace zenith::bench {
namespace {

using strip::StripRig;

// Filled once, then used by all repetitions.
StripRig& strip_of(int landmarks) {
  static std::map<int, std::unique_ptr<StripRig>> rigs;
  std::unique_ptr<StripRig>& rig = rigs[landmarks];
  if (!rig) rig = std::make_unique<StripRig>(landmarks);
  return *rig;
}

void report(benchmark::State& state, StripRig& rig, double candidates) {
  state.counters["map"] = rig.map_size();
  state.counters["candidates"] = candidates / static_cast<double>(state.iterations());
  state.counters["error_m"] = rig.error_m();
}

// The filter alone.
void map_size_filter(benchmark::State& state) {
  StripRig& rig = strip_of(static_cast<int>(state.range(0)));
  double candidates = 0.0;
  for (auto _ : state) {
    rig.look(rig.next_step());
    time_iteration(state, [&] { rig.update(); });
    candidates += static_cast<double>(rig.candidates());
  }
  report(state, rig, candidates);
}

// Filter and publication, without peers: then no map is searched (see overlap_search).
void map_size_step(benchmark::State& state) {
  StripRig& rig = strip_of(static_cast<int>(state.range(0)));
  double candidates = 0.0;
  for (auto _ : state) {
    rig.look(rig.next_step());
    time_iteration(state, [&] {
      rig.update();
      rig.cooperate();
    });
    candidates += static_cast<double>(rig.candidates());
  }
  report(state, rig, candidates);
}

void sizes(benchmark::internal::Benchmark* bench) {
  for (const int n : {250, 500, 1000, 2000, 4000}) bench->Arg(n);
  bench->Iterations(200)->UseManualTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(map_size_filter)->Apply(sizes);
BENCHMARK(map_size_step)->Apply(sizes);

}  // namespace
}  // namespace zenith::bench
