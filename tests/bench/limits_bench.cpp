// The machine's limits, beside which the kernels' rates stand.

#include <cstring>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "platform/linux/cpu.h"
#include "tests/bench/limits.h"

namespace zenith::bench {

#ifdef __x86_64__
extern const Limit kLimitPairsAvx2;
extern const Limit kLimitFloatsAvx2;
extern const Limit kLimitBytesAvx512;
extern const Limit kLimitFloatsAvx512;
#endif

std::vector<Limit> limits() {
  std::vector<Limit> all;
#ifdef __x86_64__
  if (cpu_has(Isa::kAvx2)) all.insert(all.end(), {kLimitPairsAvx2, kLimitFloatsAvx2});
  if (cpu_has(Isa::kAvx512)) all.insert(all.end(), {kLimitBytesAvx512, kLimitFloatsAvx512});
#endif
  return all;
}

namespace {

constexpr int kRounds = 100000;

void limit(benchmark::State& state, const Limit& limit) {
  for (auto _ : state) limit.run(kRounds);
  state.counters["MAC/s"] = benchmark::Counter(
      static_cast<double>(limit.products_each) * kRounds * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
}

// Reading memory of so many KiB again and again.
void limit_reading(benchmark::State& state) {
  const auto bytes = static_cast<std::size_t>(state.range(0)) * 1024;
  std::vector<char> memory(bytes, 1);
  for (auto _ : state) benchmark::DoNotOptimize(std::memchr(memory.data(), 2, bytes));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}
BENCHMARK(limit_reading)->Arg(16)->Arg(512)->Arg(8192)->Arg(131072);

const bool registered = [] {
  for (const Limit& l : limits()) {
    benchmark::RegisterBenchmark(("limit/" + std::string(l.name)).c_str(), limit, l)
        ->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
}  // namespace zenith::bench
