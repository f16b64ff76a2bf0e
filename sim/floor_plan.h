#pragma once
// The building's geometry: spaces (rooms and doors) with flat ceilings, and boxes that hang from
// them. Seen from below it is a height field over axis-parallel rectangles:
//
//   height(x, y) = the lowest surface above the floor at (x, y); 0 in solid wall
//
// so a ray from below is stopped where it first rises above height(x, y). Every visible piece of
// surface is a facet: a rectangle in an axis-parallel plane. Metres, world frame.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/world_file.h"

namespace zenith::sim {

using FacetId = std::uint16_t;
inline constexpr FacetId kNoFacet = 0xFFFF;
inline constexpr FacetId kFloorFacet = 0;

enum class FacetOwner { kFloor, kRoom, kDoor, kBox };
enum class FacetPart { kHorizontal, kWest, kEast, kSouth, kNorth };

// In-plane coordinates (a, b): (x, y) for axis 2, (y, z) for axis 0, (x, z) for axis 1.
struct Facet {
  int axis = 2;         // of the normal
  float offset = 0.0F;  // the plane: coordinate[axis] = offset
  float a0 = 0.0F, a1 = 0.0F, b0 = 0.0F, b1 = 0.0F;
  FacetOwner owner = FacetOwner::kFloor;
  std::size_t index = 0;  // of the room, door or box in the world file
  FacetPart part = FacetPart::kHorizontal;
  // Openings in it, as a range of FloorPlan::holes(): rectangles in (a, b).
  std::uint32_t first_hole = 0;
  std::uint32_t hole_count = 0;
};

struct Hole {
  float a0 = 0.0F, a1 = 0.0F, b0 = 0.0F, b1 = 0.0F;
};

struct Cell {
  float height = 0.0F;         // 0: solid
  FacetId ceiling = kNoFacet;  // the horizontal facet above
  FacetId space = kNoFacet;    // first side facet of the room or door (west, east, south, north)
  FacetId box = kNoFacet;      // first side facet of the box, if one hangs here
};

class FloorPlan {
 public:
  static Result<FloorPlan> build(const WorldFile& world);

  const std::vector<Facet>& facets() const { return facets_; }
  const Hole* holes(const Facet& facet) const { return holes_.data() + facet.first_hole; }

  // The grid of cells between all edges' coordinates.
  const std::vector<double>& xs() const { return xs_; }
  const std::vector<double>& ys() const { return ys_; }
  std::size_t column(double x) const;  // of the cell that holds x
  std::size_t row(double y) const;
  const Cell& cell(std::size_t column, std::size_t row) const {
    return cells_[row * (xs_.size() - 1) + column];
  }

  // True when a disc of this radius stands in rooms and doors alone.
  bool is_free(const Eigen::Vector2d& centre, double radius_m) const;

 private:
  FacetId add_facets(FacetOwner owner, std::size_t index, const Rect& rect, double horizontal_z,
                     double side_z0, double side_z1);
  void collect_edges(const WorldFile& world);
  void fill_cells(const Rect& rect, double height, FacetId first, bool is_box);
  void cut_holes(const WorldFile& world);

  std::vector<Facet> facets_;
  std::vector<Hole> holes_;
  std::vector<double> xs_;
  std::vector<double> ys_;
  std::vector<Cell> cells_;
};

}  // namespace zenith::sim
