#pragma once
// How walls, door reveals, hanging boxes and the floor look. Canvas coordinates: along the facet's
// first in-plane axis from a0, and up (walls) from b0.

#include <vector>

#include "sim/canvas.h"
#include "sim/floor_plan.h"

namespace zenith::sim {

// A door in a wall, in the wall's canvas: from a0 to a1 along it, up to height_m.
struct Opening {
  double a0 = 0.0;
  double a1 = 0.0;
  double height_m = 0.0;
};

// A piece of canvas that shines by itself (exit signs).
struct LitSign {
  Rect rect;
  bool mirrored = false;
};

// Returns the signs, which paint_sign() draws after the light has fallen.
std::vector<LitSign> paint_wall(Canvas& canvas, const RoomSpec& room,
                                const std::vector<Opening>& openings, Random& random);
void paint_sign(Canvas& canvas, const LitSign& sign);

void paint_door_reveal(Canvas& canvas);

// The underside when `underside`, else one side. `along_a` tells whether the box's length runs
// along the canvas's first axis.
void paint_box(Canvas& canvas, BoxKind kind, bool underside, bool along_a, Random& random);

void paint_floor(Canvas& canvas, Random& random);

}  // namespace zenith::sim
