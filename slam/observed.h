#pragma once
// From the own SLAM to the fleet: what this frame shows of the own map.

#include "slam/features.h"
#include "slam/fleet/overlap.h"
#include "slam/mapper.h"

namespace zenith {

// The promoted landmarks that were matched in the last used frame, each with this frame's look.
void observe(const Mapper& mapper, const Features& features, ObservedFrame& out);

}  // namespace zenith
