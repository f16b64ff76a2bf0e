#pragma once
// How a room's ceiling looks: tiles or plaster or concrete, and what is set into it. Reflectance
// is painted first, then the light falls on it, then the lamps shine.

#include "sim/canvas.h"
#include "sim/light.h"
#include "sim/world_file.h"

namespace zenith::sim {

// On a canvas whose origin is the room's corner (x0, y0).
void paint_ceiling(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout, bool lamps_on,
                   std::uint64_t seed, std::size_t index);

// After the light: what shines by itself.
void paint_lit_lamps(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout);

}  // namespace zenith::sim
