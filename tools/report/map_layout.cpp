#include "tools/report/map_layout.h"

#include <algorithm>
#include <optional>

#include "tools/report/ate.h"

namespace zenith::tools {
namespace {

using Placements = std::vector<std::optional<Pose2>>;  // T_common_start of each robot
using Points = std::vector<Eigen::Vector2d>;

bool ends_merged(const RobotLog& own, int peer) {
  if (own.frames.empty()) return false;
  const PeerLog* view = find_peer(own.frames.back(), peer);
  return view != nullptr && view->state == AlignmentState::kMerged;
}

// From the first robot outwards along merged transforms, either robot's view of the other.
Placements place_robots(const TeamLog& log) {
  const int size = static_cast<int>(log.robots.size());
  Placements placed(log.robots.size());
  placed[0] = Pose2{};
  for (int round = 0; round < size; ++round) {
    for (int a = 0; a < size; ++a) {
      for (int b = 0; b < size; ++b) {
        if (a == b || !placed[a] || placed[b]) continue;
        const RobotLog& from = log.robots[a];
        const RobotLog& to = log.robots[b];
        if (ends_merged(from, b)) {
          placed[b] = *placed[a] * find_peer(from.frames.back(), b)->T_own_peer;
        } else if (ends_merged(to, a)) {
          placed[b] = *placed[a] * find_peer(to.frames.back(), a)->T_own_peer.inverse();
        }
      }
    }
  }
  return placed;
}

void add_landmark(const LandmarkEstimate& mark, const Pose2& T, int robot, bool common,
                  MapLayout& layout) {
  const Eigen::Matrix2d R = rotation(T.theta_rad);
  layout.landmarks.push_back({T * mark.position_m.head<2>(),
                              R * mark.covariance_m2.topLeftCorner<2, 2>() * R.transpose(), robot,
                              common});
}

// The first robot's common map, and the own maps of those that it does not hold.
void add_landmarks(const TeamLog& log, const Placements& placed, const std::vector<Pose2>& T,
                   MapLayout& layout) {
  if (log.robots[0].fused.empty()) {
    for (const LandmarkEstimate& mark : log.robots[0].landmarks) {
      add_landmark(mark, {}, 0, false, layout);
    }
  }
  for (const auto& fused : log.robots[0].fused) {
    const int robot = fused.source < 0 ? 0 : peer_of_slot(0, fused.source);
    add_landmark(fused.landmark, {}, robot, fused.owners > 1, layout);
  }
  for (int i = 1; i < static_cast<int>(log.robots.size()); ++i) {
    if (placed[i] && ends_merged(log.robots[0], i)) continue;
    for (const LandmarkEstimate& mark : log.robots[i].landmarks) {
      add_landmark(mark, T[i], i, false, layout);
    }
  }
}

// The truth of all robots of a group, moved onto their estimates together.
void add_truth(const TeamLog& log, const std::vector<std::size_t>& group, MapLayout& layout) {
  Points truth;
  Points estimate;
  for (const std::size_t i : group) {
    for (std::size_t f = 0; f < log.robots[i].frames.size(); ++f) {
      if (!log.robots[i].frames[f].truth) continue;
      truth.push_back(log.robots[i].frames[f].truth->position());
      estimate.push_back(layout.robots[i].path[f]);
    }
  }
  const Pose2 T = align_rigid(truth, estimate);
  for (const std::size_t i : group) {
    for (const FrameLog& frame : log.robots[i].frames) {
      if (frame.truth) layout.robots[i].truth.push_back(T * frame.truth->position());
    }
  }
}

struct Bounds {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  void include(const Eigen::Vector2d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

// Where the robot was, and its landmarks around: a stray one far away does not shrink the picture.
Bounds bounds_of(const RobotLog& robot, const Pose2& T) {
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(4.0);
  Bounds path{T.position(), T.position()};
  for (const FrameLog& frame : robot.frames) path.include(T * frame.T_start_robot.position());
  Bounds bounds = path;
  for (const LandmarkEstimate& mark : robot.landmarks) {
    const Eigen::Vector2d at = T * mark.position_m.head<2>();
    bounds.include(at.cwiseMax(path.min - around).cwiseMin(path.max + around));
  }
  return bounds;
}

// Robots without a place go to the right of those that have one.
std::vector<Pose2> complete(const TeamLog& log, const Placements& placed, Bounds& all) {
  constexpr double kBeside_m = 3.0;
  std::vector<Pose2> T(placed.size());
  all = bounds_of(log.robots[0], {});
  const auto take_in = [&](std::size_t i) {
    const Bounds bounds = bounds_of(log.robots[i], T[i]);
    all.include(bounds.min);
    all.include(bounds.max);
  };
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (!placed[i]) continue;
    T[i] = *placed[i];
    take_in(i);
  }
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i]) continue;
    const Bounds own = bounds_of(log.robots[i], {});
    T[i] = {all.max.x() + kBeside_m - own.min.x(),
            0.5 * (all.min.y() + all.max.y() - own.min.y() - own.max.y()), 0.0};
    take_in(i);
  }
  return T;
}

}  // namespace

MapLayout lay_out_map(const TeamLog& log) {
  MapLayout layout;
  const Placements placed = place_robots(log);
  Bounds all;
  const std::vector<Pose2> T = complete(log, placed, all);
  std::vector<std::size_t> group;
  for (std::size_t i = 0; i < log.robots.size(); ++i) {
    PlacedRobot robot;
    robot.name = log.robots[i].name;
    robot.placed = placed[i].has_value();
    for (const FrameLog& frame : log.robots[i].frames) {
      robot.path.push_back(T[i] * frame.T_start_robot.position());
    }
    layout.robots.push_back(std::move(robot));
    if (placed[i]) group.push_back(i);
  }
  add_truth(log, group, layout);
  for (std::size_t i = 0; i < log.robots.size(); ++i) {
    if (!placed[i]) add_truth(log, {i}, layout);
  }
  add_landmarks(log, placed, T, layout);
  layout.min_m = all.min;
  layout.max_m = all.max;
  return layout;
}

}  // namespace zenith::tools
