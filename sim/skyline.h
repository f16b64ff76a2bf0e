#pragma once
// Which facet is seen in which direction from one place: for each of kBins azimuths, the facets
// from the zenith down, with the slope (height over horizontal distance) at which each ends.
//
// The floor plan is a height field seen from below, so along one azimuth a facet hides everything
// beyond it with a larger slope; one walk over the plan's cells finds them all.

#include <vector>

#include "sim/floor_plan.h"

namespace zenith::sim {

class Skyline {
 public:
  static constexpr int kBins = 4096;

  // From (x, y, z); directions below `min_slope` are not looked at.
  void look(const FloorPlan& plan, double x, double y, double z, float min_slope);

  // The azimuth in turns, any value >= 0; exact to half a bin.
  FacetId facet(float turn, float slope) const {
    const auto bin = static_cast<std::size_t>(turn * kBins) & (kBins - 1);
    const Entry* entry = entries_.data() + starts_[bin];
    while (slope <= entry->lower) ++entry;
    return entry->facet;
  }

 private:
  struct Entry {
    float lower;  // the facet is seen at slopes above this, down from the entry before
    FacetId facet;
  };

  void walk(const FloorPlan& plan, double x, double y, double z, double azimuth_rad,
            float min_slope);
  void push(float lower, FacetId facet, std::size_t start);

  std::vector<Entry> entries_;
  std::vector<std::size_t> starts_;
};

}  // namespace zenith::sim
