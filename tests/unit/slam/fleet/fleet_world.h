#pragma once
// Peers in the world of points: what a peer publishes of its landmarks, and what a robot sees.

#include <memory>

#include "slam/fleet/overlap.h"
#include "slam/fleet/peer_map.h"
#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"

namespace zenith::point_world {

// A landmark as the peer tells of it; `T_peer_world` takes the world into the peer's frame. The
// look of every landmark points along the world's x axis.
inline LandmarkRecord record_of(const PointLandmark& l, std::uint32_t id, std::uint32_t revision,
                                const Pose2& T_peer_world, double sigma_m = 0.02) {
  LandmarkRecord r;
  const Eigen::Vector2d at = T_peer_world * l.p_m.head<2>();
  r.id = id;
  r.revision = revision;
  r.x_m = static_cast<float>(at.x());
  r.y_m = static_cast<float>(at.y());
  r.z_m = static_cast<float>(l.p_m.z());
  const auto variance = static_cast<float>(sigma_m * sigma_m);
  r.covariance_m2 = {variance, 0.0F, 0.0F, variance, 0.0F, variance};
  r.observations = 10;
  r.appearance_count = 1;
  r.appearances[0] = {l.compact.values, static_cast<float>(wrap_angle(T_peer_world.theta_rad))};
  return r;
}

// The same landmark from a robot, `sigma_m` off.
inline Observed observed_of(const PointLandmark& l, int slot, const Pose2& T_world_robot,
                            double sigma_m, Random& random) {
  Observed o;
  o.slot = slot;
  o.id = static_cast<std::uint32_t>(slot) + 1;
  o.from_robot_m = T_world_robot.inverse() * l.p_m.head<2>();
  o.from_robot_m.x() += sigma_m * random.normal();
  o.from_robot_m.y() += sigma_m * random.normal();
  o.z_m = l.p_m.z();
  o.z_sigma_m = 0.02;
  o.orientation_rad = static_cast<float>(wrap_angle(-T_world_robot.theta_rad));
  o.compact = l.compact;
  return o;
}

// All landmarks within `reach_m` of the robot.
inline void observe_near(const PointWorld& world, const Pose2& T_world_robot, double reach_m,
                         double sigma_m, Random& random, ObservedFrame& out) {
  out.clear();
  for (std::size_t i = 0; i < world.landmarks.size(); ++i) {
    const PointLandmark& l = world.landmarks[i];
    if ((l.p_m.head<2>() - T_world_robot.position()).norm() > reach_m) continue;
    out.push_back(observed_of(l, static_cast<int>(i), T_world_robot, sigma_m, random));
  }
}

// A peer that knows the whole world; slot i is landmark i.
struct PeerRig {
  PeerLandmarkPool pool;
  PeerMap map;
  ArenaBlock block{[this](Arena& arena) {
    pool.layout(arena);
    map.layout(arena, pool);
  }};

  PeerRig() = default;
  PeerRig(const PointWorld& world, const Pose2& T_peer_world) {
    for (std::size_t i = 0; i < world.landmarks.size(); ++i) {
      map.apply(record_of(world.landmarks[i], static_cast<std::uint32_t>(i) + 1, 1, T_peer_world));
    }
  }
};

}  // namespace zenith::point_world
