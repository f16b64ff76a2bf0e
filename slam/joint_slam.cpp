#include "slam/joint_slam.h"

#include <algorithm>
#include <new>

#include "platform/base/ensure.h"
#include "slam/slam_state.h"

namespace zenith {

struct JointSlam::State {
  JointFilter filter;
  std::array<Slam*, kMaxObservers> slams = {};
  int count = 0;
  std::span<SlotPair> pairs;  // kMaxCorrespondences

  void layout(Arena& arena, const Parameters& parameters) {
    filter.layout(arena, parameters);
    pairs = arena.take<SlotPair>(kMaxCorrespondences);
  }
};

namespace {

// The slot of the landmark with this id, or -1.
int find_slot(const Map& map, std::uint32_t id) {
  const auto landmarks = map.landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    if (l.state != LandmarkState::kFree && l.id == id) return static_cast<int>(slot);
  }
  return -1;
}

}  // namespace

std::size_t JointSlam::memory_needed(const Parameters& parameters) {
  Arena arena;
  arena.take<std::byte>(sizeof(State));
  State state;
  state.layout(arena, within_limits(parameters));
  return arena.used();
}

JointSlam::JointSlam(const Parameters& parameters, std::span<std::byte> memory) {
  ensure(memory.size() >= memory_needed(parameters), "JointSlam: memory_needed() bytes are needed");
  Arena arena(memory);
  state_ = new (arena.take<std::byte>(sizeof(State)).data()) State;
  state_->layout(arena, within_limits(parameters));
  state_->filter.build(within_limits(parameters));
}

JointSlam::~JointSlam() {
  state_->~State();
}

void JointSlam::add(Slam& slam) {
  ensure(state_->count < kMaxObservers, "JointSlam: more robots than kMaxObservers");
  state_->slams[static_cast<std::size_t>(state_->count++)] = &slam;
  state_->filter.add(slam.state_->mapper);
}

void JointSlam::step(std::span<const Frame> frames) {
  State& s = *state_;
  const auto slam = [&s](int robot) -> Slam& { return *s.slams[static_cast<std::size_t>(robot)]; };
  for (int group = 0; group < s.count; ++group) {
    if (s.filter.leader(group) != group) continue;
    const bool alone = s.filter.size_of_group(group) == 1;
    FixedVector<JointFrame, kMaxObservers> used;
    for (const Frame& f : frames) {
      if (s.filter.leader(f.robot) != group) continue;
      if (alone) {
        slam(f.robot).step(f.input);
        continue;
      }
      Slam::State& own = *slam(f.robot).state_;
      if (!own.accept(f.input)) continue;
      if (own.begin(f.input)) used.push_back({f.robot, own.moved, own.features, &own.extractor});
    }
    if (alone) continue;
    if (!used.empty()) s.filter.update(used.span());
    for (const Frame& f : frames) {
      if (s.filter.leader(f.robot) != group) continue;
      const bool was_used = std::any_of(used.begin(), used.end(),
                                        [&f](const JointFrame& u) { return u.robot == f.robot; });
      Slam::State& own = *slam(f.robot).state_;
      if (!own.output.accepted) continue;
      if (f.robot == group) own.cooperate(was_used);
      own.finish(was_used, s.filter.T_leader_start(f.robot).inverse());
    }
  }
}

bool JointSlam::join(int host, int guest, const Pose2& T_host_guest,
                     std::span<const Correspondence> correspondences) {
  State& s = *state_;
  const Map& own = s.slams[static_cast<std::size_t>(host)]->state_->mapper.map();
  const Map& other = s.slams[static_cast<std::size_t>(guest)]->state_->mapper.map();
  std::size_t count = 0;
  for (const Correspondence& c : correspondences) {
    const SlotPair pair = {find_slot(own, c.own_id), find_slot(other, c.peer_id)};
    if (pair.own >= 0 && pair.other >= 0 && count < s.pairs.size()) s.pairs[count++] = pair;
  }
  return s.filter.join(host, guest, T_host_guest, s.pairs.first(count));
}

int JointSlam::leader(int robot) const {
  return state_->filter.leader(robot);
}

const Pose2& JointSlam::T_leader_start(int robot) const {
  return state_->filter.T_leader_start(robot);
}

const JointCounters& JointSlam::counters() const {
  return state_->filter.counters();
}

}  // namespace zenith
