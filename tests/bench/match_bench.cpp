// Matching: 100 patches against 40 000, the best and the runner-up of another landmark for each.
// The kernels beside what one would build from Eigen and OpenBLAS: a product of float matrices of
// patches made unit-norm, whose rows are then searched in the same way.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "platform/base/random.h"
#include "slam/image/patch.h"
#include "slam/kernels/match/exact_search.h"
#include "tests/bench/match_peers.h"
#include "tests/support/isas_here.h"
#include "tests/support/wave_patches.h"

namespace zenith::bench {
namespace {

constexpr int kQueryCount = 100;
constexpr int kLookCount = 40000;
constexpr int kLooksOfLandmark = 4;
constexpr double kNoise = 0.1;

// Patches of waves, the long ones stronger; looks of a landmark are alike.
struct MatchData {
  struct Entry {
    CompactPatch compact;
    Outline outline;
  };
  MatchData() {
    Random random(5);
    PatchValues like = {};
    for (int i = 0; i < kLookCount; ++i) {
      landmarks.push_back(i / kLooksOfLandmark);
      if (i % kLooksOfLandmark == 0) like = random_waves(random);
      add(random, like, full, entries);
    }
    for (int q = 0; q < kQueryCount; ++q) {
      const Patch& seen = full[static_cast<std::size_t>(random.below(kLookCount))];
      std::copy(seen.values.begin(), seen.values.end(), like.begin());
      for (float& v : like) v /= 50.0F;
      add(random, like, query_full, query_entries);
    }
  }
  // Seen once more, with noise.
  static void add(Random& random, PatchValues values, std::vector<Patch>& patches,
                  std::vector<Entry>& entries) {
    for (float& v : values) v += static_cast<float>(kNoise * random.normal());
    patches.push_back(quantised(values));
    Entry e;
    e.compact = compact(patches.back());
    e.outline = outline(patches.back(), e.compact);
    entries.push_back(e);
  }

  std::vector<Patch> full;
  std::vector<Entry> entries;
  std::vector<std::int32_t> landmarks;
  std::vector<Patch> query_full;
  std::vector<Entry> query_entries;
};

const MatchData& data() {
  static const MatchData d;
  return d;
}

// What is matched: whole patches or compact forms.
template <int kLength>
struct Form;
template <>
struct Form<256> {
  static const Patch& look(int i) { return data().full[static_cast<std::size_t>(i)]; }
  static const Patch& query(int i) { return data().query_full[static_cast<std::size_t>(i)]; }
  static constexpr std::size_t kStride = sizeof(Patch);
};
template <>
struct Form<32> {
  static const CompactPatch& look(int i) {
    return data().entries[static_cast<std::size_t>(i)].compact;
  }
  static const CompactPatch& query(int i) {
    return data().query_entries[static_cast<std::size_t>(i)].compact;
  }
  static constexpr std::size_t kStride = sizeof(MatchData::Entry);
};

template <int kLength>
Looks all_looks() {
  const auto& first = Form<kLength>::look(0);
  return {first.values.data(), &first.inverse_norm, Form<kLength>::kStride, kLookCount};
}

// Column for column, as unit vectors: kLength x count.
template <typename At>
std::vector<float> matrix(int count, const At& at) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) {
    for (const std::int8_t v : at(i).values) {
      out.push_back(static_cast<float>(v) * at(i).inverse_norm);
    }
  }
  return out;
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
  data();  // made now, not in the first iteration
  const MatchKernels<kLength>& kernels = kernels_of<kLength>(match_table(isa));
  auto queries = std::make_unique<MatchQueries<kLength>>();
  std::vector<TwoBest> found(kQueryCount);
  for (auto _ : state) {
    // Packing is part of the work: the corners of a frame are new each time.
    queries->count = 0;
    for (int q = 0; q < kQueryCount; ++q) {
      const auto& patch = Form<kLength>::query(q);
      kernels.pack(*queries, patch.values.data(), patch.inverse_norm);
    }
    std::fill(found.begin(), found.end(), TwoBest{});
    kernels.two_best(*queries, all_looks<kLength>(), data().landmarks.data(), 0, found.data());
    benchmark::DoNotOptimize(found.data());
  }
  count_rates(state, kLength);
}

// The same answer as match_two_best<256>, most patches being ruled out by their compact form.
void match_two_best_exact(benchmark::State& state, Isa isa) {
  data();
  const MatchTable& table = match_table(isa);
  auto queries = std::make_unique<ExactQueries>();
  std::vector<TwoBest> found(kQueryCount);
  const ExactLooks looks = {data().entries[0].compact.values.data(),
                            &data().entries[0].outline,
                            sizeof(MatchData::Entry),
                            data().full[0].values.data(),
                            &data().full[0].inverse_norm,
                            sizeof(Patch),
                            kLookCount};
  for (auto _ : state) {
    queries->compact.count = 0;
    for (std::size_t q = 0; q < kQueryCount; ++q) {
      const MatchData::Entry& e = data().query_entries[q];
      const Patch& patch = data().query_full[q];
      pack(table, e.compact.values.data(), e.outline, patch.values.data(), patch.inverse_norm,
           *queries);
    }
    std::fill(found.begin(), found.end(), TwoBest{});
    two_best_exact(table, *queries, looks, data().landmarks.data(), 0, found.data());
    benchmark::DoNotOptimize(found.data());
  }
  count_rates(state, 256);
}

template <int kLength>
void match_gemm(benchmark::State& state, const GemmPeer& peer) {
  const std::vector<float> looks = matrix(kLookCount, Form<kLength>::look);
  const std::vector<float> queries = matrix(kQueryCount, Form<kLength>::query);
  std::vector<float> products(static_cast<std::size_t>(kQueryCount) * kGemmBlock);
  std::vector<TwoBest> found(kQueryCount);
  for (auto _ : state) {
    std::fill(found.begin(), found.end(), TwoBest{});
    gemm_two_best(peer, kLength, looks, queries, data().landmarks, products, found);
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
    benchmark::RegisterBenchmark(("match_two_best_exact/" + name).c_str(), match_two_best_exact,
                                 isa)
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
