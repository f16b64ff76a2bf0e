#pragma once
// The own map as records for peers: what this robot saw itself, nothing that it was told.

#include <span>

#include "slam/fleet/record.h"
#include "slam/map/map.h"

namespace zenith {

// First the landmarks that are gone. Then promoted landmarks whose place, certainty or looks
// changed enough since they were last told, each with its next revision. Writes at most out.size();
// the rest follows with the next call.
std::size_t publish_changes(Map& map, std::span<LandmarkRecord> out);

}  // namespace zenith
