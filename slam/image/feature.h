#pragma once
// A corner with what it looks like: what the image stage hands to the filter.

#include "slam/image/patch.h"

namespace zenith {

struct Feature {
  float zx = 0.0F;  // tangents in the level image
  float zy = 0.0F;
  float noise = 0.0F;  // variance of zx and of zy, set by the filter
  float u_px = 0.0F;
  float v_px = 0.0F;
  float orientation_rad = 0.0F;  // in the image's, that is the robot's axes
  bool described = false;        // has contrast enough for a patch
  Patch patch;
  CompactPatch compact;
};

}  // namespace zenith
