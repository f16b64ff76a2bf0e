#include "slam/slam.h"

#include <algorithm>
#include <new>

#include "platform/base/ensure.h"
#include "slam/fleet/fusion.h"
#include "slam/fleet/publish.h"
#include "slam/image/view.h"
#include "slam/slam_state.h"

namespace zenith {

MemoryTable Slam::memory_table(const Parameters& given) {
  const Parameters parameters = within_limits(given);
  MemoryTable table;
  Arena arena(table);
  arena.part("state of the step");
  arena.take<std::byte>(sizeof(State));
  State state;
  state.layout(arena, parameters);
  return table;
}

Slam::Slam(const RobotConfig& robot, const Parameters& given, std::uint64_t seed,
           std::span<std::byte> memory) {
  int limited = 0;
  const Parameters parameters = with_fitted_view(within_limits(given, &limited), robot);
  ensure(memory.size() >= memory_needed(parameters), "Slam: memory_needed() bytes are needed");
  Arena arena(memory);
  state_ = new (arena.take<std::byte>(sizeof(State)).data()) State;
  state_->layout(arena, parameters);
  state_->extractor.build(robot, parameters);
  state_->mapper.build(robot, parameters, seed);
  state_->wheels.build(robot.wheels, state_->mapper.motion_noise());
  state_->fleet.build(parameters);
  state_->watch.build(robot);
  state_->counters.parameters_limited = static_cast<std::uint64_t>(limited);
}

Slam::~Slam() {
  state_->~State();
}

void Slam::add_wheels(std::span<const WheelSample> samples) {
  state_->add_wheels(samples);
}

const StepOutput& Slam::step(const StepInput& input) {
  State& s = *state_;
  if (!s.accept(input)) return s.output;
  const bool use = s.begin(input);
  if (use) s.mapper.update(s.moved, *s.features, s.extractor);
  s.cooperate(use && s.mapper.tracking() == TrackingState::kTracking);
  s.finish(use, {});
  return s.output;
}

void Slam::State::add_wheels(std::span<const WheelSample> samples) {
  for (const WheelSample& sample : samples) {
    if (!wheels.add(sample)) ++counters.odometry_rejected;
  }
  counters.odometry_jumps = wheels.jumps();
}

bool Slam::State::accept(const StepInput& input) {
  add_wheels(input.wheels);
  output.accepted =
      extractor.fits(input.frame) && stamps.take(input.stamp) != StampGuard::Verdict::kRefused;
  ++(output.accepted ? counters.frames : counters.frames_refused);
  return output.accepted;
}

bool Slam::State::begin(const StepInput& input) {
  const WheelMotion::Since since = wheels.advance(clock.taken(input.stamp));
  if (since.extrapolated) ++counters.odometry_extrapolated;
  if (since.known) {
    dead_reckoning.advance(wheels.with_floor(since.motion), input.stamp - output.stamp);
    output.odometry = dead_reckoning.odometry();
  }
  unused = unused * since.motion;
  moved = wheels.with_floor(unused);
  features = &extractor.extract(input.frame, input.corners_max);
  output.stamp = input.stamp;
  output.stamp_jitter_s = clock.jitter_s();
  output.corners = static_cast<int>(features->size());
  watch.observe({input.stamp, features->span(), extractor.rectified(), extractor.repeated()},
                wheels.history());
  const bool due =
      mapper.worth_using(moved) || (!extractor.repeated() && mapper.sees_push(*features));
  output.repeated = due && extractor.repeated();
  counters.frames_repeated += output.repeated ? 1 : 0;
  return due && !output.repeated;
}

void Slam::State::cooperate(bool used_frame) {
  if (used_frame) {
    observe(mapper, *features, observed);
    fleet.update(observed, mapper.map(), mapper.pose().mean, mapper.travelled_m());
  } else {
    fleet.rest(mapper.map());
  }
}

void Slam::State::finish(bool used_frame, const Pose2& T_own_map) {
  PoseEstimate pose = {mapper.pose().mean, mapper.pose_covariance()};
  used_last = used_frame;
  output.tracking = mapper.tracking();
  watch.note_tracking(output.tracking == TrackingState::kLost, output.stamp);
  if (used_frame) {
    unused = {};
  } else {
    const PoseEstimate now = pose * moved;
    if (is_usable(now.mean) && is_covariance(now.covariance)) pose = now;
  }
  output.T_start_robot = T_own_map * pose.mean;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(T_own_map.theta_rad);
  output.pose_covariance = R * pose.covariance * R.transpose();
  output.effective_sample_size = mapper.effective_sample_size();
  output.corner_sigma_px = mapper.corner_sigma_px();
  output.candidates = 0;
  output.matched = 0;
  output.inliers = 0;
  if (output.repeated) return;
  for (const Candidate& c : mapper.candidates()) {
    ++output.candidates;
    output.matched += c.corner >= 0 ? 1 : 0;
    output.inliers += c.inlier ? 1 : 0;
  }
}

const StepOutput& Slam::output() const {
  return state_->output;
}

void Slam::look(Picture& out) const {
  const State& s = *state_;
  out.stamp = s.output.stamp;
  out.used = s.used_last;
  out.corners.clear();
  if (s.features == nullptr) return;
  const ImageView image = s.extractor.rectified();
  std::copy_n(image.data, out.image.size(), out.image.begin());
  for (const Feature& f : *s.features) out.corners.push_back({f.u_px, f.v_px});
  // Without use the candidates are those of an older frame.
  if (!out.used) return;
  for (const Candidate& c : s.mapper.candidates()) {
    if (c.corner < 0) continue;
    SeenCorner& seen = out.corners[static_cast<std::size_t>(c.corner)];
    const Eigen::Vector2d at = s.extractor.pinhole().pixel(c.m);
    seen.landmark = s.mapper.map().info(c.slot).id;
    seen.inlier = c.inlier;
    seen.predicted_u_px = static_cast<float>(at.x());
    seen.predicted_v_px = static_cast<float>(at.y());
  }
}

const SetupVerdict& Slam::verdict() const {
  return state_->watch.verdict();
}

const SetupMeasures& Slam::setup_measures() const {
  return state_->watch.measures();
}

StepCounters Slam::counters() const {
  StepCounters c = state_->counters;
  c.mapper = state_->mapper.counters();
  c.records_refused = state_->fleet.records_refused();
  c.removals_untold = state_->mapper.map().removals_untold();
  return c;
}

std::size_t Slam::landmarks(std::span<LandmarkEstimate> out) const {
  std::size_t count = 0;
  for (const LandmarkInfo& l : state_->mapper.map().landmarks()) {
    if (count == out.size()) break;
    if (l.state != LandmarkState::kPromoted) continue;
    out[count++] = {l.id, l.position_m(), state_->mapper.landmark_covariance(l), l.observations};
  }
  return count;
}

std::size_t Slam::publish(std::span<LandmarkRecord> out) {
  const std::size_t count = publish_changes(state_->mapper.map(), out);
  state_->fleet.receive_own(out.first(count));
  return count;
}

bool Slam::State::knows(int peer) {
  if (peer >= 0 && peer < kMaxPeers) return true;
  ++counters.calls_refused;
  return false;
}

void Slam::receive(int peer, std::span<const LandmarkRecord> records) {
  if (state_->knows(peer)) state_->fleet.receive(peer, records);
}

void Slam::remember(int peer, std::span<const LandmarkRecord> records) {
  if (!state_->knows(peer)) return;
  state_->fleet.receive(peer, records);
  state_->fleet.note_past(peer);
}

void Slam::forget(int peer) {
  if (state_->knows(peer)) state_->fleet.forget(peer);
}

void Slam::offer_alignment(int peer, const Pose2& T_own_peer) {
  if (!state_->knows(peer)) return;
  if (is_usable(T_own_peer)) {
    state_->fleet.offer_alignment(peer, T_own_peer);
  } else {
    ++state_->counters.calls_refused;
  }
}

std::span<const Alignment> Slam::alignments() const {
  return state_->fleet.alignments();
}

std::span<const Correspondence> Slam::correspondences(int peer) const {
  if (peer < 0 || peer >= kMaxPeers) return {};
  const Peer& p = state_->fleet.peers()[static_cast<std::size_t>(peer)];
  return std::span<const Correspondence>(p.pairs).first(p.pair_count);
}

std::size_t Slam::fused_landmarks(std::span<FusedLandmark> out) const {
  return read_common_map(state_->mapper.map(), state_->fleet, out);
}

}  // namespace zenith
