#pragma once
// What is set into a ceiling besides lamps: air outlets, sprinklers, smoke detectors, loudspeakers,
// hatches, water stains, cables. Painted flat; their number follows the room's clutter.

#include "sim/canvas.h"
#include "sim/light.h"

namespace zenith::sim {

void paint_fixtures(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout, Random& random);

}  // namespace zenith::sim
