#include "tools/runner/member.h"

#include <chrono>
#include <new>

namespace zenith::tools {
namespace {

constexpr std::size_t kAlignment = 64;

std::byte* allocate_block(std::size_t bytes) {
  const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  void* block = std::aligned_alloc(kAlignment, rounded);
  if (block == nullptr) throw std::bad_alloc();
  return static_cast<std::byte*>(block);
}

}  // namespace

Member::Member(Source& source, const Parameters& parameters, std::uint64_t seed, int index,
               int team_size)
    : source_(source),
      index_(index),
      team_size_(team_size),
      memory_bytes_(Slam::memory_needed(parameters)),
      memory_(allocate_block(memory_bytes_)) {
  slam_.emplace(source.config(), parameters, seed, std::span(memory_.get(), memory_bytes_));
  log_.name = source.name();
  log_.memory_bytes = memory_bytes_;
  log_.frames.reserve(static_cast<std::size_t>(source.frame_count()));
}

Result<bool> Member::advance() {
  auto more = source_.next(frame_);
  has_frame_ = more.ok() && *more;
  return more;
}

void Member::step() {
  const Lens& lens = source_.config().lens;
  StepInput input;
  input.stamp = frame_.stamp;
  input.frame = {frame_.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
  input.wheels = frame_.wheels;
  const auto before = std::chrono::steady_clock::now();
  const StepOutput& output = slam_->step(input);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  log_step(output, took.count());
}

void Member::log_step(const StepOutput& output, double step_s) {
  FrameLog log;
  log.stamp = frame_.stamp;
  log.T_start_robot = output.T_start_robot;
  log.odometry = odometry_.advance(source_.config().wheels, frame_.stamp, frame_.wheels);
  log.truth = frame_.truth;
  log.step_s = step_s;
  log.corners = output.corners;
  log.candidates = output.candidates;
  log.matched = output.matched;
  log.inliers = output.inliers;
  log.effective_sample_size = output.effective_sample_size;
  for (const Alignment& alignment : slam_->alignments()) {
    log.peers.push_back({peer_of_slot(index_, alignment.peer), alignment.state,
                         alignment.T_own_peer, alignment.covariance.diagonal(),
                         alignment.confidence, alignment.correspondences});
  }
  log_.frames.push_back(std::move(log));
}

RobotLog Member::finish() {
  log_.counters = slam_->counters();
  log_.landmarks.resize(kMaxLandmarks);
  log_.landmarks.resize(slam_->landmarks(log_.landmarks));
  log_.fused.resize(kMaxLandmarks + std::size_t{kMaxPeers} * kMaxPeerLandmarks);
  log_.fused.resize(slam_->fused_landmarks(log_.fused));
  log_.correspondences.resize(static_cast<std::size_t>(team_size_));
  for (int peer = 0; peer < team_size_; ++peer) {
    if (peer == index_) continue;
    const auto pairs = slam_->correspondences(slot_of_peer(index_, peer));
    log_.correspondences[static_cast<std::size_t>(peer)].assign(pairs.begin(), pairs.end());
  }
  return std::move(log_);
}

}  // namespace zenith::tools
