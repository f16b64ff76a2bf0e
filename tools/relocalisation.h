#pragma once
// How a robot finds itself in a stored map: a world's first robot maps the building alone, its map
// goes through the bytes of a file, and every other robot starts in it, knowing neither where it is
// nor which way it looks.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "slam/parameters.h"

namespace zenith::tools {

struct RelocalisationPlan {
  std::string world;
  std::uint64_t seed = 1;
  Parameters parameters;
  double most_way_m = 2.0;    // driven until it must be found
  double right_m = 0.5;       // farther off, or
  double right_rad = 0.0873;  // turned by more (5 degrees), is wrong
};

struct RelocalisationStart {
  std::string robot;
  bool found = false;
  bool right = false;
  double way_m = 0.0;    // driven until it was found, or in all
  double error_m = 0.0;  // of the robot's place in the map when it was found, and
  double error_rad = 0.0;
};

struct RelocalisationRun {
  std::size_t landmarks = 0;
  std::size_t map_bytes = 0;
  double mapped_way_m = 0.0;
  double map_error_m = 0.0;  // of the mapping robot's last pose
  std::vector<RelocalisationStart> starts;
};

using RelocalisationProgress = std::function<void(double fraction)>;

Result<RelocalisationRun> relocalise(const RelocalisationPlan& plan,
                                     const RelocalisationProgress& progress);

// A table and the figures, for people.
std::string relocalisation_text(const RelocalisationRun& run);

}  // namespace zenith::tools
