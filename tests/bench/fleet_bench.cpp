// The search for common landmarks in a peer's map, from one frame that shows 60: real looks from
// rendered frames, scattered over 500 m2; four looks of each, all at heights that agree.

#include <array>

#include <benchmark/benchmark.h>

#include "slam/fleet/hough.h"
#include "tests/bench/scattered_peer.h"
#include "tests/support/arena_block.h"

namespace zenith::bench {
namespace {

constexpr int kObserved = 60;

class FleetRig {
 public:
  explicit FleetRig(int landmarks)
      : block_([this](Arena& arena) {
          pool_.layout(arena);
          peer_.layout(arena, pool_);
          hough_.layout(arena);
          matches_ = arena.take<OverlapMatches>(1);
        }) {
    for (int i = 0; i < landmarks; ++i) add_landmark(static_cast<std::uint32_t>(i));
  }

  const ObservedFrame& frame() const { return frame_; }
  const PeerMap& peer() const { return peer_; }
  HoughSearch& hough() { return hough_; }
  OverlapMatches& matches() { return matches_[0]; }

 private:
  // The first landmarks are what the frame shows, around the origin with heading 0.
  void add_landmark(std::uint32_t index) {
    LandmarkRecord r = scattered_.record(index);
    const bool visible = index < kObserved;
    const Feature& f = scattered_.look(index);
    const Eigen::Vector2d from_robot(2.25 * static_cast<double>(f.zx),
                                     2.25 * static_cast<double>(f.zy));
    if (visible) {
      r.x_m = static_cast<float>(from_robot.x());
      r.y_m = static_cast<float>(from_robot.y());
    }
    if (!peer_.apply(r) || !visible) return;
    Observed o;
    o.slot = static_cast<int>(index);
    o.id = r.id;
    o.from_robot_m = from_robot;
    o.z_m = 2.55;
    o.z_sigma_m = 0.02;
    o.orientation_rad = f.orientation_rad;
    o.compact = f.compact;
    frame_.push_back(o);
  }

  ScatteredPeer scattered_{3};
  ObservedFrame frame_;
  PeerLandmarkPool pool_;
  PeerMap peer_;
  HoughSearch hough_;
  std::span<OverlapMatches> matches_;
  ArenaBlock block_;
};

void overlap_search(benchmark::State& state) {
  FleetRig rig(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    find_overlap(rig.frame(), rig.peer(), OverlapSettings{}, rig.matches());
    benchmark::DoNotOptimize(rig.matches().size());
  }
  state.counters["matches"] = static_cast<double>(rig.matches().size());
}
BENCHMARK(overlap_search)->Arg(500)->Arg(2000)->Arg(4000)->Unit(benchmark::kMicrosecond);

// All that a fleet knows: 10 000 landmarks in the maps of three peers.
void overlap_search_of_a_fleet(benchmark::State& state) {
  std::array<FleetRig, 3> rigs = {FleetRig(3334), FleetRig(3333), FleetRig(3333)};
  for (auto _ : state) {
    for (FleetRig& rig : rigs) {
      find_overlap(rig.frame(), rig.peer(), OverlapSettings{}, rig.matches());
      benchmark::DoNotOptimize(rig.matches().size());
    }
  }
}
BENCHMARK(overlap_search_of_a_fleet)->Unit(benchmark::kMicrosecond);

void hough_places(benchmark::State& state) {
  FleetRig rig(2000);
  find_overlap(rig.frame(), rig.peer(), OverlapSettings{}, rig.matches());
  PlaceFixes fixes;
  for (auto _ : state) {
    rig.hough().find_places(rig.matches(), HoughSettings{}, fixes);
    benchmark::DoNotOptimize(fixes.size());
  }
  state.counters["inliers"] = fixes.empty() ? 0.0 : fixes[0].inliers;
}
BENCHMARK(hough_places)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace zenith::bench
