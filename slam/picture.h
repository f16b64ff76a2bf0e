#pragma once
// What one frame showed, for people who look at it: the level image, its corners, and the landmarks
// that they were taken for. Plain data, about 105 kB.
//
// Pixels are those of the level image: u grows forward, v grows left (slam/README.md, Frames).

#include <array>
#include <cstdint>

#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"
#include "slam/capacity.h"

namespace zenith {

struct SeenCorner {
  float u_px = 0.0F;
  float v_px = 0.0F;
  std::uint32_t landmark = 0;   // it was taken for; 0: for none
  bool inlier = false;          // the match agrees with the others on the pose
  float predicted_u_px = 0.0F;  // where this landmark was expected
  float predicted_v_px = 0.0F;
};

struct Picture {
  Time stamp;
  bool used = false;  // the robot had moved enough for the frame to tell anything; else no matches
  FixedVector<SeenCorner, kMaxCorners> corners;
  std::array<std::uint8_t, std::size_t{kRectifiedSize}* kRectifiedSize> image = {};
};

}  // namespace zenith
