#include "tools/runner/member.h"

#include <algorithm>
#include <chrono>

namespace zenith::tools {

Member::Member(Source& source, const Parameters& parameters, std::uint64_t seed, int index,
               int team_size)
    : source_(source),
      index_(index),
      team_size_(team_size),
      memory_(Slam::memory_needed(parameters)) {
  slam_.emplace(source.config(), parameters, seed, memory_.span());
  log_.name = source.name();
  log_.memory = Slam::memory_table(parameters);
  log_.frames.reserve(static_cast<std::size_t>(source.frame_count()));
}

Result<bool> Member::advance() {
  auto more = source_.next(frame_);
  has_frame_ = more.ok() && *more;
  return more;
}

StepInput Member::input() const {
  const Lens& lens = source_.config().lens;
  StepInput input;
  input.stamp = frame_.stamp;
  input.frame = {frame_.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
  input.wheels = frame_.wheels;
  return input;
}

void Member::step() {
  const auto before = std::chrono::steady_clock::now();
  slam_->step(input());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  log_step(took.count());
}

void Member::log_step(double step_s) {
  const StepOutput& output = slam_->output();
  FrameLog log;
  log.stamp = frame_.stamp;
  log.T_start_robot = output.T_start_robot;
  log.odometry = output.odometry.T_odom_robot;
  log.truth = frame_.truth;
  log.step_s = step_s;
  log.corners = output.corners;
  log.candidates = output.candidates;
  log.matched = output.matched;
  log.inliers = output.inliers;
  log.effective_sample_size = output.effective_sample_size;
  log.pose_covariance = output.pose_covariance;
  log.peers = partners_;
  for (const Alignment& alignment : slam_->alignments()) {
    const int peer = peer_of_slot(index_, alignment.peer);
    if (find_peer(log, peer) != nullptr) continue;
    log.peers.push_back({peer, alignment.state, alignment.T_own_peer,
                         alignment.covariance.diagonal(), alignment.confidence,
                         alignment.correspondences});
  }
  log_.frames.push_back(std::move(log));
}

void Member::share_filter(const Pose2& T_leader_start, std::vector<PeerLog> peers) {
  T_start_map_ = T_leader_start.inverse();
  partners_ = std::move(peers);
}

void Member::to_start_frame(LandmarkEstimate& landmark) const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(T_start_map_.theta_rad);
  landmark.position_m.head<2>() = T_start_map_ * Eigen::Vector2d(landmark.position_m.head<2>());
  landmark.covariance_m2 = R * landmark.covariance_m2 * R.transpose();
}

std::vector<LandmarkEstimate> Member::landmarks() const {
  std::vector<LandmarkEstimate> landmarks(kMaxLandmarks);
  landmarks.resize(slam_->landmarks(landmarks));
  if (partners_.empty()) return landmarks;
  for (LandmarkEstimate& landmark : landmarks) to_start_frame(landmark);
  return landmarks;
}

void Member::read_maps() {
  log_.landmarks = landmarks();
  if (partners_.empty()) {
    log_.fused.resize(std::size_t{kMaxLandmarks} + kPeerLandmarkPool);
    log_.fused.resize(slam_->fused_landmarks(log_.fused));
    return;
  }
  // One map for all: what a leader read of its partners before they were one is in it already.
  for (const LandmarkEstimate& landmark : log_.landmarks) {
    log_.fused.push_back({landmark, static_cast<int>(partners_.size()) + 1, -1});
  }
}

RobotLog Member::finish() {
  log_.counters = slam_->counters();
  log_.corner_sigma_px = slam_->output().corner_sigma_px;
  log_.verdict = slam_->verdict();
  log_.setup = slam_->setup_measures();
  read_maps();
  log_.correspondences.resize(static_cast<std::size_t>(team_size_));
  for (int peer = 0; peer < team_size_; ++peer) {
    if (peer == index_) continue;
    const auto pairs = slam_->correspondences(slot_of_peer(index_, peer));
    log_.correspondences[static_cast<std::size_t>(peer)].assign(pairs.begin(), pairs.end());
  }
  return std::move(log_);
}

}  // namespace zenith::tools
