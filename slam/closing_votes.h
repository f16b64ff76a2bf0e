#pragma once
// Where the robot may be, by votes: each old landmark votes, for every similar corner within reach,
// for the jumps (forward, left, turn) that bring it there.
//
//   m' = R(turn)^T (m - rho (t + (R(turn) - I) lever)) = z
//
// for given turn a translation t. The grid's unit of translation is a share of the landmarks'
// height, which is what an image tells.

#include <span>

#include "platform/base/arena.h"
#include "slam/geometry.h"
#include "slam/image/feature.h"
#include "slam/map/association.h"
#include "slam/map/map.h"

namespace zenith {

class ClosingVotes {
 public:
  void layout(Arena& arena);
  // `pixel`: of the rectified image, normalised.
  void build(double pixel, float ncc_min);

  // Empties the grid. `rho`: about the inverse height of the landmarks; turns beyond
  // `most_turn_rad` get no votes.
  void begin(double rho, double most_turn_rad);
  // The votes of a landmark, predicted for a robot that heads to `heading_rad`.
  void add(const Candidate& landmark, const Map& map, std::span<const Feature> features,
           double heading_rad);
  // Takes the highest peak out of the grid: the jump in the body. False when none is left.
  bool take_peak(Pose2& jump);

 private:
  float& at(int turn, int y, int x);
  float around(int turn, int y, int x);

  double pixel_ = 0.0;
  float ncc_min_ = 0.0F;
  double cell_m_ = 1.0;
  int turns_ = 0;
  std::span<float> grid_;
};

// The camera's place in the body, from a prediction's derivative.
Eigen::Vector2d lever_of(const Candidate& candidate);

}  // namespace zenith
