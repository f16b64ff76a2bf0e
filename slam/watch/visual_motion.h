#pragma once
// How the camera moved between two frames, from their corners alone: no wheels, no map, nothing
// predicted. Independent of the filter, whose gates take the set-up for right.
//
// Corners are matched by appearance all over the image. The differences of the patches' directions
// vote for the rotation, then the matches that agree vote for the shift; small motions win ties,
// for ceilings repeat themselves. The winner is refined on the corners of the dominant plane:
//
//   z_after = R(-turn) (z_before - c),      z: tangents in the level image, c: camera's way /
//   height
//
// by the closed form of Umeyama, PAMI 1991, without scale.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"
#include "slam/image/feature.h"
#include "slam/watch/lens_fit.h"

namespace zenith {

// The corners of a frame that are kept for the comparison.
struct KeptCorner {
  Eigen::Vector2f z = Eigen::Vector2f::Zero();
  float direction_rad = 0.0F;
  CompactPatch appearance;
};
using KeptCorners = FixedVector<KeptCorner, 64>;

// The strongest that have contrast. `features`: strongest first.
void keep_corners(std::span<const Feature> features, KeptCorners& out);

struct VisualMotion {
  bool known = false;
  double turn_rad = 0.0;  // of the robot, counter-clockwise
  // The camera's way in units of the height of what it sees, in body axes at half of the turn.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  int matches = 0;     // corners that look like one of the other frame's
  int inliers = 0;     // that agree on the motion
  double share = 0.0;  // of the corners that may move
  int standing = 0;    // that stay where they were, while the others move
  Eigen::Vector2d standing_at = Eigen::Vector2d::Zero();  // their mean place, tangents
  double moved = 0.0;  // by the inliers, root mean square, tangents
  LensEvidence lens;   // of the inliers
};

// `expected`: the shift that the wheels lead to (as VisualMotion::shift, before it is turned to the
// middle), where that is known. It decides between shifts for which about as much speaks, under
// ceilings that repeat themselves, and nothing else.
VisualMotion visual_motion(const KeptCorners& before, std::span<const Feature> after,
                           std::optional<Eigen::Vector2d> expected = {});

}  // namespace zenith
