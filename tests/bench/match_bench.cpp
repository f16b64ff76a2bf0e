// Matching: 100 patches against 40 000, the best and the runner-up of another landmark for each.
// The kernels beside what one would build from Eigen and OpenBLAS: a product of float matrices of
// patches made unit-norm, whose rows are then searched in the same way.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "platform/base/random.h"
#include "slam/kernels/match/match.h"
#include "tests/bench/match_peers.h"
#include "tests/support/isas_here.h"

namespace zenith::bench {
namespace {

constexpr int kQueryCount = 100;
constexpr int kLookCount = 40000;
constexpr int kLooksOfLandmark = 4;

// Patches of a few waves, as smooth as real ones; looks of a landmark are alike.
template <int kLength>
class MatchData {
 public:
  struct Patch {
    std::int8_t values[kLength];
    float inverse_norm;
  };
  MatchData() : looks(kLookCount), landmarks(kLookCount), queries(kQueryCount) {
    Random random(5);
    for (int i = 0; i < kLookCount; ++i) {
      const auto at = static_cast<std::size_t>(i);
      landmarks[at] = i / kLooksOfLandmark;
      if (i % kLooksOfLandmark == 0) {
        for (float& v : like_) v = static_cast<float>(random.normal());
      }
      looks[at] = patch(random);
    }
    for (int q = 0; q < kQueryCount; ++q) {
      const Patch& like = looks[static_cast<std::size_t>(random.below(kLookCount))];
      for (std::size_t i = 0; i < kLength; ++i)
        like_[i] = static_cast<float>(like.values[i]) / 40.0F;
      queries[static_cast<std::size_t>(q)] = patch(random);
    }
  }
  Looks all() const { return {looks[0].values, &looks[0].inverse_norm, sizeof(Patch), kLookCount}; }
  // Column for column, as unit vectors: kLength x count.
  static std::vector<float> matrix(const std::vector<Patch>& patches) {
    std::vector<float> out;
    for (const Patch& p : patches) {
      for (const std::int8_t v : p.values) out.push_back(static_cast<float>(v) * p.inverse_norm);
    }
    return out;
  }

  std::vector<Patch> looks;
  std::vector<std::int32_t> landmarks;
  std::vector<Patch> queries;

 private:
  Patch patch(Random& random) {
    Patch p;
    double squares = 0.0;
    for (std::size_t i = 0; i < kLength; ++i) {
      const double v = 30.0 * (static_cast<double>(like_[i]) + 0.3 * random.normal());
      p.values[i] = static_cast<std::int8_t>(std::clamp(v, -127.0, 127.0));
      squares += p.values[i] * p.values[i];
    }
    p.inverse_norm = static_cast<float>(1.0 / std::sqrt(squares));
    return p;
  }
  std::array<float, kLength> like_ = {};
};

template <int kLength>
const MatchData<kLength>& data() {
  static const MatchData<kLength> d;
  return d;
}

double products(int length) {
  return double{kQueryCount} * kLookCount * length;
}

void count_rates(benchmark::State& state, int length) {
  state.counters["MAC/s"] = benchmark::Counter(
      products(length) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

template <int kLength>
void match_two_best(benchmark::State& state, Isa isa) {
  const MatchKernels<kLength>& kernels = kernels_of<kLength>(match_table(isa));
  auto queries = std::make_unique<MatchQueries<kLength>>();
  std::vector<TwoBest> found(kQueryCount);
  for (auto _ : state) {
    // Packing is part of the work: the corners of a frame are new each time.
    queries->count = 0;
    for (const auto& q : data<kLength>().queries) kernels.pack(*queries, q.values, q.inverse_norm);
    std::fill(found.begin(), found.end(), TwoBest{});
    kernels.two_best(*queries, data<kLength>().all(), data<kLength>().landmarks.data(), 0,
                     found.data());
    benchmark::DoNotOptimize(found.data());
  }
  count_rates(state, kLength);
}

template <int kLength>
void match_gemm(benchmark::State& state, const GemmPeer& peer) {
  const std::vector<float> looks = MatchData<kLength>::matrix(data<kLength>().looks);
  const std::vector<float> queries = MatchData<kLength>::matrix(data<kLength>().queries);
  std::vector<float> products(static_cast<std::size_t>(kQueryCount) * kGemmBlock);
  std::vector<TwoBest> found(kQueryCount);
  for (auto _ : state) {
    std::fill(found.begin(), found.end(), TwoBest{});
    gemm_two_best(peer, kLength, looks, queries, data<kLength>().landmarks, products, found);
    benchmark::DoNotOptimize(found.data());
  }
  count_rates(state, kLength);
}

const bool registered = [] {
  for (const Isa isa : isas_here()) {
    const std::string name(isa_name(isa));
    benchmark::RegisterBenchmark(("match_two_best<256>/" + name).c_str(), match_two_best<256>, isa)
        ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("match_two_best<32>/" + name).c_str(), match_two_best<32>, isa)
        ->Unit(benchmark::kMicrosecond);
  }
  for (const GemmPeer& peer : gemm_peers()) {
    const std::string name(peer.name);
    benchmark::RegisterBenchmark(("match_gemm<256>/" + name).c_str(), match_gemm<256>, peer)
        ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("match_gemm<32>/" + name).c_str(), match_gemm<32>, peer)
        ->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
}  // namespace zenith::bench
