// The whole step, Slam::step(), over a rendered drive: mean CPU time of a frame.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "platform/base/memory_block.h"
#include "slam/slam.h"
#include "tests/bench/rendered_drive.h"
#include "tests/bench/scattered_peer.h"
#include "tests/bench/stopwatch.h"

namespace zenith::bench {
namespace {

constexpr std::size_t kFirst = 15;  // before, the robot stands

// One Slam after the other drives through the frames.
class StepRig {
 public:
  // `peers`: maps that the robot knows from the beginning and never finds itself in.
  StepRig(const RobotConfig& robot, const Parameters& parameters, int peers, int landmarks)
      : robot_(robot), parameters_(parameters), memory_(Slam::memory_needed(parameters)) {
    for (int i = 0; i < peers; ++i) {
      ScatteredPeer scattered(static_cast<std::uint64_t>(i));
      std::vector<LandmarkRecord> map;
      for (int k = 0; k < landmarks; ++k) {
        map.push_back(scattered.record(static_cast<std::uint32_t>(k)));
      }
      peers_.push_back(std::move(map));
    }
    restart();
  }
  void restart() {
    slam_.reset();
    slam_ = std::make_unique<Slam>(robot_, parameters_, 1, memory_.span());
    for (std::size_t i = 0; i < peers_.size(); ++i) {
      slam_->receive(static_cast<int>(i), peers_[i]);
    }
    next_ = 0;
    while (next_ < kFirst) step();
  }
  const StepOutput& step() {
    const RenderedDrive& drive = corridor_rooms();
    const RenderedFrame& frame = drive.frames[next_];
    return slam_->step({frame.stamp, drive.image(next_++), frame.wheels});
  }
  bool at_end() const { return next_ == corridor_rooms().frames.size(); }

 private:
  RobotConfig robot_;
  Parameters parameters_;
  MemoryBlock memory_;
  std::unique_ptr<Slam> slam_;
  std::size_t next_ = 0;
  std::vector<std::vector<LandmarkRecord>> peers_;
};

void time_steps(benchmark::State& state, StepRig& rig) {
  std::vector<double> times;
  double candidates = 0.0;
  double inliers = 0.0;
  for (auto _ : state) {
    if (rig.at_end()) rig.restart();
    const double start = thread_seconds();
    const StepOutput& output = rig.step();
    times.push_back(thread_seconds() - start);
    state.SetIterationTime(times.back());
    candidates += output.candidates;
    inliers += output.inliers;
  }
  const auto n = static_cast<double>(times.size());
  std::sort(times.begin(), times.end());
  state.counters["median_ms"] = 1e3 * times[times.size() / 2];
  state.counters["p95_ms"] = 1e3 * times[times.size() * 95 / 100];
  state.counters["max_ms"] = 1e3 * times.back();
  state.counters["candidates"] = candidates / n;
  state.counters["inliers"] = inliers / n;
}

void step(benchmark::State& state) {
  Parameters parameters;
  parameters.particles = static_cast<int>(state.range(0));
  parameters.optimal_proposal = static_cast<int>(state.range(1));
  StepRig rig(corridor_rooms().robot, parameters, 0, 0);
  time_steps(state, rig);
}
BENCHMARK(step)
    ->ArgNames({"particles", "optimal"})
    ->ArgsProduct({{50, 200, 800}, {0, 1}})
    ->Iterations(250)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// With the search for overlaps with peers' maps.
void step_with_peers(benchmark::State& state) {
  StepRig rig(corridor_rooms().robot, Parameters{}, static_cast<int>(state.range(0)),
              static_cast<int>(state.range(1)));
  time_steps(state, rig);
}
BENCHMARK(step_with_peers)
    ->ArgNames({"peers", "landmarks"})
    ->ArgsProduct({{0, 1, 4, 8}, {2000}})
    ->Iterations(250)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace zenith::bench
