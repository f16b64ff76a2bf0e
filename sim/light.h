#pragma once
// Where a room's lamps are and how they light it.
//
//   q(p) = gain * sum over lamps of A / (|p - p_lamp|^2 + soft^2),   1 on average
//   E(p) = 0.55 + 0.45 * 1.6 q / (0.6 + q)
//
// relative to ordinary office light; with the lamps off, daylight falls in from one side of the
// room and fades with the distance from it. Edges and corners are a little darker (occlusion).
// This is a look, not photometry.

#include <vector>

#include <Eigen/Core>

#include "sim/world_file.h"

namespace zenith::sim {

struct Lamp {
  Rect rect;           // in the ceiling's plane, world coordinates
  bool round = false;  // the disc in the rectangle
  bool dead = false;   // never lit
};

// The grid of the suspended ceiling and the lamps that sit in it.
struct RoomLayout {
  double grid_x = 0.0;  // a grid line runs through it
  double grid_y = 0.0;
  std::vector<Lamp> lamps;
};

inline constexpr double kTile_m = 0.6;
inline constexpr float kLampRadiance = 3.2F;

RoomLayout lay_out_room(const RoomSpec& room, std::uint64_t seed, std::size_t index);

class RoomLight {
 public:
  RoomLight(const RoomSpec& room, const RoomLayout& layout, bool lamps_on, std::uint64_t seed,
            std::size_t index);
  // On a surface whose normal is along `axis`.
  double at(const Eigen::Vector3d& point, int axis) const;

 private:
  double lamps_at(const Eigen::Vector3d& point) const;

  const RoomSpec& room_;
  const RoomLayout& layout_;
  bool lamps_on_;
  double gain_ = 0.0;
  int window_side_ = 0;  // west, east, south, north
};

}  // namespace zenith::sim
