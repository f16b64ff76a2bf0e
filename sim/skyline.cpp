#include "sim/skyline.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace zenith::sim {
namespace {

constexpr float kBelowAll = -std::numeric_limits<float>::infinity();

// One axis of the walk over the cells: where the next edge is and which cell follows.
struct Axis {
  Axis(const std::vector<double>& edges, std::size_t cell, double from, double direction)
      : edges_(edges), index(cell), from_(from), direction_(direction) {
    aim();
  }
  void step() {
    index = direction_ > 0.0 ? index + 1 : index - 1;
    aim();
  }
  bool forward() const { return direction_ > 0.0; }

 private:
  void aim() {
    if (direction_ == 0.0) {
      next = std::numeric_limits<double>::infinity();
    } else {
      next = (edges_[forward() ? index + 1 : index] - from_) / direction_;
    }
  }
  const std::vector<double>& edges_;

 public:
  std::size_t index;
  double next = 0.0;  // distance along the ray to the edge ahead

 private:
  double from_;
  double direction_;
};

// The face between a cell and the lower one beyond it. Side facets come in the order west, east,
// south, north; a room's are seen from inside, a box's from outside.
FacetId face(const Cell& from, const Cell& to, bool across_x, bool forward) {
  const int inner = (across_x ? 0 : 2) + (forward ? 1 : 0);
  const int outer = (across_x ? 0 : 2) + (forward ? 0 : 1);
  if (to.box != kNoFacet) return static_cast<FacetId>(to.box + outer);
  return static_cast<FacetId>(from.space + inner);
}

}  // namespace

void Skyline::look(const FloorPlan& plan, double x, double y, double z, float min_slope) {
  entries_.clear();
  starts_.resize(kBins);
  for (int bin = 0; bin < kBins; ++bin) {
    starts_[static_cast<std::size_t>(bin)] = entries_.size();
    walk(plan, x, y, z, 2.0 * std::numbers::pi * (bin + 0.5) / kBins, min_slope);
  }
}

void Skyline::push(float lower, FacetId facet, std::size_t start) {
  if (entries_.size() > start && entries_.back().facet == facet) {
    entries_.back().lower = lower;
  } else {
    entries_.push_back({lower, facet});
  }
}

void Skyline::walk(const FloorPlan& plan, double x, double y, double z, double azimuth_rad,
                   float min_slope) {
  const std::size_t start = entries_.size();
  Axis ax(plan.xs(), plan.column(x), x, std::cos(azimuth_rad));
  Axis ay(plan.ys(), plan.row(y), y, std::sin(azimuth_rad));
  float seen = std::numeric_limits<float>::infinity();  // down to this slope all is known
  const Cell* cell = &plan.cell(ax.index, ay.index);
  while (cell->height > 0.0F) {
    const bool across_x = ax.next < ay.next;
    Axis& axis = across_x ? ax : ay;
    const auto inverse = static_cast<float>(1.0 / std::max(1e-9, axis.next));
    const float ceiling = (cell->height - static_cast<float>(z)) * inverse;
    if (ceiling < seen) {
      push(ceiling, cell->ceiling, start);
      seen = ceiling;
    }
    axis.step();
    const Cell* beyond = &plan.cell(ax.index, ay.index);
    const float bottom = (beyond->height - static_cast<float>(z)) * inverse;
    if (beyond->height < cell->height && bottom < seen) {
      push(bottom, face(*cell, *beyond, across_x, axis.forward()), start);
      seen = bottom;
    }
    cell = beyond;
    if (seen < min_slope) break;
  }
  // Solid wall was reached, or nothing further is looked at; below is the floor.
  push(kBelowAll, kFloorFacet, start);
}

}  // namespace zenith::sim
