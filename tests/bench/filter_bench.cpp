// The filter's kernels over 200 particles and 50 landmarks: one frame's worth.

#include <algorithm>
#include <numeric>
#include <vector>

#include <benchmark/benchmark.h>

#include "slam/filter/proposal.h"
#include "slam/filter/resample.h"
#include "slam/map/map.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/arena_block.h"

namespace zenith::bench {
namespace {

constexpr int kParticles = 200;
constexpr int kVisible = 50;
constexpr float kNoise = 4e-5F;

// Particles around the origin and a map of landmarks that they began 1 m ago.
class FilterRig {
 public:
  explicit FilterRig(int landmarks)
      : block_([this](Arena& arena) {
          particles_.layout(arena, kParticles);
          map_.layout(arena, kParticles);
          proposal_.layout(arena, kParticles);
          const auto n = static_cast<std::size_t>(row_stride(kParticles));
          prediction_ = {arena.take<float>(n).data(), arena.take<float>(n).data(),
                         arena.take<float>(n).data(), arena.take<float>(n).data(),
                         arena.take<float>(n).data()};
        }) {
    map_.reset();
    Random random(1);
    std::fill_n(particles_.weight.begin(), kParticles, 1.0 / kParticles);
    move_to(-1.0, random);
    const int anchor = map_.create_anchor(particles_.camera, PoseSensitivity::Zero());
    for (int i = 0; i < landmarks; ++i) {
      const int slot = map_.create(anchor);
      seen_.push_back({static_cast<float>(random.uniform(-1.0, 1.0)),
                       static_cast<float>(random.uniform(-1.0, 1.0))});
      start_landmark(map_.rows(slot), kParticles, seen_.back().x(), seen_.back().y(), kNoise, 0.4F,
                     0.1F);
    }
    move_to(0.0, random);
  }

  Particles& particles() { return particles_; }
  Map& map() { return map_; }
  ProposalRows& proposal() { return proposal_; }
  const PredictionRows& prediction() const { return prediction_; }
  // Where landmark `i` is seen now: a metre nearer.
  Eigen::Vector2f seen(int i) const {
    return seen_[static_cast<std::size_t>(i)] - Eigen::Vector2f(0.4F, 0.0F);
  }

 private:
  void move_to(double x_m, Random& random) {
    for (int i = 0; i < kParticles; ++i) {
      particles_.set_pose(
          i, {x_m + 0.01 * random.normal(), 0.01 * random.normal(), 0.005 * random.normal()});
    }
    place_cameras(particles_, {0.06, -0.02});
  }

  Particles particles_;
  Map map_;
  ProposalRows proposal_;
  PredictionRows prediction_;
  std::vector<Eigen::Vector2f> seen_;
  ArenaBlock block_;
};

void predict_50(benchmark::State& state) {
  FilterRig rig(kVisible);
  for (auto _ : state) {
    for (int i = 0; i < kVisible; ++i) {
      predict_landmark(rig.map().rows(i), rig.particles().camera, kParticles, rig.prediction());
      benchmark::ClobberMemory();
    }
  }
}
BENCHMARK(predict_50)->Unit(benchmark::kMicrosecond);

void add_to_proposal_50(benchmark::State& state) {
  FilterRig rig(kVisible);
  for (auto _ : state) {
    rig.proposal().clear(kParticles);
    for (int i = 0; i < kVisible; ++i) {
      const Eigen::Vector2f z = rig.seen(i);
      add_to_proposal(rig.map().rows(i), rig.particles().camera, kParticles, {0.06F, -0.02F},
                      {z.x(), z.y(), kNoise}, 0.4F, rig.proposal());
    }
    benchmark::ClobberMemory();
  }
}
BENCHMARK(add_to_proposal_50)->Unit(benchmark::kMicrosecond);

void add_log_likelihood_50(benchmark::State& state) {
  FilterRig rig(kVisible);
  for (auto _ : state) {
    for (int i = 0; i < kVisible; ++i) {
      const Eigen::Vector2f z = rig.seen(i);
      add_log_likelihood(rig.map().rows(i), rig.particles().camera, kParticles,
                         {z.x(), z.y(), kNoise}, 9.0F, rig.particles().log_weight.data());
    }
    benchmark::ClobberMemory();
  }
}
BENCHMARK(add_log_likelihood_50)->Unit(benchmark::kMicrosecond);

// Every iteration updates the same young landmarks: they are started anew outside the timing.
void update_50(benchmark::State& state) {
  FilterRig rig(kVisible);
  for (auto _ : state) {
    for (int i = 0; i < kVisible; ++i) {
      const Eigen::Vector2f z = rig.seen(i);
      start_landmark(rig.map().rows(i), kParticles, z.x(), z.y(), kNoise, 0.4F, 0.1F);
    }
    time_iteration(state, [&] {
      for (int i = 0; i < kVisible; ++i) {
        const Eigen::Vector2f z = rig.seen(i);
        update_landmark(rig.map().rows(i), rig.particles().camera, kParticles, z.x(), z.y(),
                        kNoise);
      }
      benchmark::ClobberMemory();
    });
  }
}
BENCHMARK(update_50)->UseManualTime()->Unit(benchmark::kMicrosecond);

// A resampling of a map of 2000 landmarks, of which so many are then touched. 2000 of 2000 is what
// copying the whole map would cost.
void resample_then_touch(benchmark::State& state) {
  FilterRig rig(2000);
  Random random(2);
  std::vector<std::uint16_t> parents(kParticles);
  std::vector<double> weight(kParticles);
  for (double& w : weight) w = random.uniform();
  const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (double& w : weight) w /= sum;
  for (auto _ : state) {
    systematic_resample(weight, random.uniform(), parents);
    rig.map().resampled(parents);
    for (int i = 0; i < static_cast<int>(state.range(0)); ++i) {
      benchmark::DoNotOptimize(rig.map().rows(i));
    }
  }
}
BENCHMARK(resample_then_touch)->Arg(0)->Arg(50)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace zenith::bench
