#pragma once
// How much of the world a lens's image shows.

#include "slam/image/lens_projection.h"

namespace zenith {

struct LensExtent {
  double widest_rad = 0.0;  // the ray in the image that is farthest from the axis
  bool whole = false;       // every pixel has a ray; otherwise the image goes on beyond limit_rad()
};

// Of a lens whose centre lies in its image. Looks along the image's border.
LensExtent lens_extent(const LensProjection& projection);

}  // namespace zenith
