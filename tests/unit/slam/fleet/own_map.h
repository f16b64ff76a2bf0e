#pragma once
// An own map with promoted landmarks at given places, without a drive.

#include "slam/map/map.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith::point_world {

struct OwnMapRig {
  static constexpr int kParticles = 4;
  Map map;
  Particles particles;
  ArenaBlock block{[this](Arena& arena) {
    map.layout(arena, kParticles);
    particles.layout(arena, kParticles);
  }};

  OwnMapRig() { map.reset(); }

  // Slot i is landmark i while nothing was removed.
  int add(const PointLandmark& l, double sigma_m = 0.02) {
    const int slot = map.create(map.create_anchor(particles.camera, PoseSensitivity::Zero()));
    LandmarkInfo& info = map.info(slot);
    info.state = LandmarkState::kPromoted;
    info.changed = true;
    info.observations = 10;
    move(slot, l.p_m);
    const auto variance = static_cast<float>(sigma_m * sigma_m);
    for (const int i : {0, 3, 5}) info.covariance_m2[i] = variance;
    map.add_appearance(slot, l.patch, l.compact, 0.0F);
    return slot;
  }
  void move(int slot, const Eigen::Vector3d& to) {
    LandmarkInfo& info = map.info(slot);
    info.x_m = static_cast<float>(to.x());
    info.y_m = static_cast<float>(to.y());
    info.z_m = static_cast<float>(to.z());
    info.changed = true;
  }
};

}  // namespace zenith::point_world
