// Figures of pairs of robots: merges, errors of the transform, duplicates in the common map.

#include "tools/report/figures.h"

#include <algorithm>
#include <cmath>

#include "tools/report/robot_figures.h"

namespace zenith::tools {
namespace {

constexpr double kLater_s = 20.0;
constexpr double kOverlap_m = 1.5;

// The first frame of `own` whose true position lies near a place where `peer` has been by then.
std::optional<std::size_t> overlap_start(const RobotLog& own, const RobotLog& peer) {
  for (std::size_t i = 0; i < own.frames.size(); ++i) {
    const FrameLog& here = own.frames[i];
    if (!here.truth) continue;
    for (const FrameLog& past : peer.frames) {
      if (past.stamp > here.stamp) break;
      if (!past.truth) continue;
      if ((past.truth->position() - here.truth->position()).norm() < kOverlap_m) return i;
    }
  }
  return std::nullopt;
}

Time team_start(const RobotLog& own, const RobotLog& peer) {
  return std::min(own.frames.front().stamp, peer.frames.front().stamp);
}

double driven_between(const RobotLog& log, std::size_t from, std::size_t to) {
  double length = 0.0;
  for (std::size_t i = from + 1; i <= to; ++i) {
    const FrameLog& a = log.frames[i - 1];
    const FrameLog& b = log.frames[i];
    if (a.truth && b.truth) length += (b.truth->position() - a.truth->position()).norm();
  }
  return length;
}

bool merged_with(const FrameLog& frame, int peer) {
  const PeerLog* view = find_peer(frame, peer);
  return view != nullptr && view->state == AlignmentState::kMerged;
}

// The frames at which `peer` was merged anew.
std::vector<std::size_t> merge_frames(const RobotLog& own, int peer) {
  std::vector<std::size_t> frames;
  bool merged = false;
  for (std::size_t i = 0; i < own.frames.size(); ++i) {
    const bool now = merged_with(own.frames[i], peer);
    if (now && !merged) frames.push_back(i);
    merged = now;
  }
  return frames;
}

std::optional<TransformError> error_at(const FrameLog& frame, int peer,
                                       const std::optional<Pose2>& truth) {
  if (!truth || !merged_with(frame, peer)) return std::nullopt;
  return transform_error(find_peer(frame, peer)->T_own_peer, *truth);
}

void judge_duplicates(const RobotLog& own, int own_index, PairFigures& figures) {
  const int slot = slot_of_peer(own_index, figures.peer);
  const auto& pairs = own.correspondences[static_cast<std::size_t>(figures.peer)];
  figures.fused = static_cast<int>(pairs.size());
  std::vector<Eigen::Vector3d> mine;
  for (const auto& fused : own.fused) {
    if (fused.source < 0) mine.push_back(fused.landmark.position_m);
  }
  for (const auto& fused : own.fused) {
    if (fused.source != slot) continue;
    for (const Eigen::Vector3d& position : mine) {
      const double distance = (fused.landmark.position_m - position).norm();
      figures.duplicates += distance < kDuplicateDistance_m ? 1 : 0;
    }
  }
}

void judge_first_merge(const TeamLog& log, std::size_t merge, const std::optional<Pose2>& truth,
                       const std::optional<std::size_t>& overlap, PairFigures& figures) {
  const RobotLog& own = log.robots[static_cast<std::size_t>(figures.own)];
  const RobotLog& peer = log.robots[static_cast<std::size_t>(figures.peer)];
  const Time stamp = own.frames[merge].stamp;
  figures.merge_time_s = (stamp - team_start(own, peer)).seconds();
  figures.at_merge = error_at(own.frames[merge], figures.peer, truth);
  for (std::size_t i = merge; i < own.frames.size(); ++i) {
    if ((own.frames[i].stamp - stamp).seconds() < kLater_s) continue;
    figures.later = error_at(own.frames[i], figures.peer, truth);
    break;
  }
  if (overlap) figures.driven_till_merge_m = driven_between(own, *overlap, merge);
}

PairFigures judge_pair(const TeamLog& log, int own_index, int peer_index) {
  const RobotLog& own = log.robots[static_cast<std::size_t>(own_index)];
  PairFigures figures;
  figures.own = own_index;
  figures.peer = peer_index;
  const RobotLog& peer = log.robots[static_cast<std::size_t>(peer_index)];
  if (own.frames.empty() || peer.frames.empty()) return figures;
  const std::optional<Pose2> truth = true_transform(own, peer);
  const std::vector<std::size_t> merges = merge_frames(own, peer_index);
  figures.merges = static_cast<int>(merges.size());
  figures.merged_at_end = merged_with(own.frames.back(), peer_index);
  figures.withdrawn = figures.merges - (figures.merged_at_end ? 1 : 0);
  for (const std::size_t merge : merges) {
    const auto error = error_at(own.frames[merge], peer_index, truth);
    figures.false_merges += error && error->wrong() ? 1 : 0;
  }
  const auto overlap = overlap_start(own, peer);
  if (overlap)
    figures.overlap_time_s = (own.frames[*overlap].stamp - team_start(own, peer)).seconds();
  if (!merges.empty()) judge_first_merge(log, merges.front(), truth, overlap, figures);
  figures.at_end = error_at(own.frames.back(), peer_index, truth);
  if (figures.merged_at_end) judge_duplicates(own, own_index, figures);
  return figures;
}

// The last transform, when the peer is merged at the end.
std::optional<Pose2> last_transform(const TeamLog& log, int own, int peer) {
  const RobotLog& robot = log.robots[static_cast<std::size_t>(own)];
  if (own == peer || robot.frames.empty()) return std::nullopt;
  if (!merged_with(robot.frames.back(), peer)) return std::nullopt;
  return find_peer(robot.frames.back(), peer)->T_own_peer;
}

void judge_chains(const TeamLog& log, PairFigures& figures) {
  const auto there = last_transform(log, figures.own, figures.peer);
  const auto back = last_transform(log, figures.peer, figures.own);
  if (there && back) figures.round_trip = transform_error(*there * *back, {});
  const auto truth = true_transform(log.robots[static_cast<std::size_t>(figures.own)],
                                    log.robots[static_cast<std::size_t>(figures.peer)]);
  for (int via = 0; via < static_cast<int>(log.robots.size()) && !figures.through_others; ++via) {
    const auto first = last_transform(log, figures.own, via);
    const auto second = last_transform(log, via, figures.peer);
    if (!truth || !first || !second) continue;
    figures.through_others = transform_error(*first * *second, *truth);
  }
}

// Empty unless every robot of the circle holds its successor merged at the end.
std::optional<TransformError> judge_circle(const TeamLog& log) {
  const int size = static_cast<int>(log.robots.size());
  if (size < 3) return std::nullopt;
  Pose2 around;
  for (int own = 0; own < size; ++own) {
    const auto T = last_transform(log, own, (own + 1) % size);
    if (!T) return std::nullopt;
    around = around * *T;
  }
  return transform_error(around, {});
}

}  // namespace

std::optional<Pose2> true_transform(const RobotLog& own, const RobotLog& peer) {
  if (own.frames.empty() || peer.frames.empty()) return std::nullopt;
  const auto& T_world_own = own.frames.front().truth;
  const auto& T_world_peer = peer.frames.front().truth;
  if (!T_world_own || !T_world_peer) return std::nullopt;
  return T_world_own->inverse() * *T_world_peer;
}

TransformError transform_error(const Pose2& estimate, const Pose2& truth) {
  return {(estimate.position() - truth.position()).norm(),
          std::abs(wrap_angle(estimate.theta_rad - truth.theta_rad))};
}

TeamFigures judge(const TeamLog& log) {
  TeamFigures figures;
  const int size = static_cast<int>(log.robots.size());
  for (const RobotLog& robot : log.robots) figures.robots.push_back(judge_robot(robot));
  for (int own = 0; own < size; ++own) {
    for (int peer = 0; peer < size; ++peer) {
      if (own == peer) continue;
      figures.pairs.push_back(judge_pair(log, own, peer));
      judge_chains(log, figures.pairs.back());
    }
  }
  figures.circle = judge_circle(log);
  return figures;
}

}  // namespace zenith::tools
