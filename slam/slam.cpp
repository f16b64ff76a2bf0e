#include "slam/slam.h"

#include <cassert>
#include <new>

#include "slam/fleet/fleet.h"
#include "slam/fleet/fusion.h"
#include "slam/fleet/publish.h"
#include "slam/mapper.h"
#include "slam/observed.h"

namespace zenith {

struct Slam::State {
  FeatureExtractor extractor;
  Mapper mapper;
  Fleet fleet;
  ObservedFrame observed;
  WheelHistory wheels;
  WheelTravel used;        // total travel at the last used frame
  bool has_used = false;
  StepCounters counters;
  StepOutput output;

  void layout(Arena& arena, const Parameters& parameters) {
    extractor.layout(arena);
    mapper.layout(arena, parameters);
    fleet.layout(arena);
  }
};

std::size_t Slam::memory_needed(const Parameters& parameters) {
  Arena arena;
  arena.take<std::byte>(sizeof(State));
  State state;
  state.layout(arena, parameters);
  return arena.used();
}

Slam::Slam(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed,
           std::span<std::byte> memory) {
  assert(memory.size() >= memory_needed(parameters));
  Arena arena(memory);
  state_ = new (arena.take<std::byte>(sizeof(State)).data()) State;
  state_->layout(arena, parameters);
  state_->extractor.build(robot, parameters);
  state_->mapper.build(robot, parameters, seed);
  state_->fleet.build(parameters);
}

Slam::~Slam() { state_->~State(); }

const StepOutput& Slam::step(const StepInput& input) {
  State& s = *state_;
  StepOutput& out = s.output;
  ++s.counters.frames;
  for (const WheelSample& sample : input.wheels) {
    if (!s.wheels.add(sample)) ++s.counters.odometry_rejected;
  }
  const WheelHistory::At now = s.wheels.at(input.stamp);
  if (!now.known || now.extrapolated) ++s.counters.odometry_extrapolated;
  if (!s.has_used) s.used = now.total;
  const WheelTravel travel = {now.total.left_m - s.used.left_m, now.total.right_m - s.used.right_m};

  Features& features = s.extractor.extract(input.frame);
  out.stamp = input.stamp;
  out.corners = static_cast<int>(features.size());
  if (s.mapper.worth_using(travel)) {
    s.mapper.update(travel, features, s.extractor);
    observe(s.mapper, features, s.observed);
    s.fleet.update(s.observed, s.mapper.map(), s.mapper.pose().mean, s.mapper.travelled_m());
    s.used = now.total;
    s.has_used = true;
    out.T_start_robot = s.mapper.pose().mean;
  } else {
    s.fleet.rest(s.mapper.map());
    out.T_start_robot = s.mapper.pose().mean * wheel_motion(s.mapper.robot().wheels, travel);
  }
  out.pose_covariance = s.mapper.pose().covariance;
  out.effective_sample_size = s.mapper.effective_sample_size();
  out.candidates = 0;
  out.matched = 0;
  out.inliers = 0;
  for (const Candidate& c : s.mapper.candidates()) {
    ++out.candidates;
    out.matched += c.corner >= 0 ? 1 : 0;
    out.inliers += c.inlier ? 1 : 0;
  }
  return out;
}

const StepCounters& Slam::counters() const {
  StepCounters& c = state_->counters;
  const MapperCounters& m = state_->mapper.counters();
  c.resamplings = m.resamplings;
  c.landmarks_created = m.landmarks_created;
  c.landmarks_promoted = m.landmarks_promoted;
  c.landmarks_pruned = m.landmarks_pruned;
  c.landmarks_evicted = m.landmarks_evicted;
  c.landmarks_rejected_full = m.landmarks_rejected_full;
  c.appearances_rejected_full = m.appearances_rejected_full;
  return c;
}

std::size_t Slam::landmarks(std::span<LandmarkEstimate> out) const {
  std::size_t count = 0;
  for (const LandmarkInfo& l : state_->mapper.map().landmarks()) {
    if (count == out.size()) break;
    if (l.state != LandmarkState::kPromoted) continue;
    out[count++] = {l.id, l.position_m(), l.covariance(), l.observations};
  }
  return count;
}

std::size_t Slam::publish(std::span<LandmarkRecord> out) {
  const std::size_t count = publish_changes(state_->mapper.map(), out);
  state_->fleet.receive_own(out.first(count));
  return count;
}

void Slam::receive(int peer, std::span<const LandmarkRecord> records) {
  assert(peer >= 0 && peer < kMaxPeers);
  state_->fleet.receive(peer, records);
}

void Slam::offer_alignment(int peer, const Pose2& T_own_peer) {
  assert(peer >= 0 && peer < kMaxPeers);
  state_->fleet.offer_alignment(peer, T_own_peer);
}

std::span<const Alignment> Slam::alignments() const { return state_->fleet.alignments(); }

std::span<const Correspondence> Slam::correspondences(int peer) const {
  const Peer& p = state_->fleet.peers()[static_cast<std::size_t>(peer)];
  return std::span<const Correspondence>(p.pairs).first(p.pair_count);
}

std::size_t Slam::fused_landmarks(std::span<FusedLandmark> out) const {
  return read_common_map(state_->mapper.map(), state_->fleet, out);
}

}  // namespace zenith
