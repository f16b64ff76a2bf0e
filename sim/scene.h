#pragma once
// The textures of all facets of a floor plan under one light: painted, lit, with mip levels.

#include <vector>

#include "sim/floor_plan.h"
#include "sim/light.h"
#include "sim/texture.h"

namespace zenith::sim {

class Scene {
 public:
  // The same seed gives the same surfaces whether the lamps are on or off.
  Scene(const WorldFile& world, const FloorPlan& plan, std::uint64_t seed, bool lamps_on);

  const Texture& texture(FacetId facet) const { return textures_[facet]; }
  std::size_t bytes() const;

 private:
  std::vector<Texture> textures_;
};

}  // namespace zenith::sim
