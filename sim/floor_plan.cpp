#include "sim/floor_plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace zenith::sim {
namespace {

constexpr double kSameEdge_m = 1e-6;
constexpr std::size_t kMaxFacets = 60'000;

bool overlap(const Rect& a, const Rect& b) {
  return a.x0 < b.x1 - kSameEdge_m && b.x0 < a.x1 - kSameEdge_m && a.y0 < b.y1 - kSameEdge_m &&
         b.y0 < a.y1 - kSameEdge_m;
}

bool inside(const Rect& inner, const Rect& outer) {
  return inner.x0 >= outer.x0 - kSameEdge_m && inner.x1 <= outer.x1 + kSameEdge_m &&
         inner.y0 >= outer.y0 - kSameEdge_m && inner.y1 <= outer.y1 + kSameEdge_m;
}

std::size_t room_of(const WorldFile& world, const Rect& rect) {
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    if (inside(rect, world.rooms[i].rect)) return i;
  }
  return world.rooms.size();
}

Status check(const WorldFile& world) {
  std::string text;
  const auto complain = [&](unsigned line, const std::string& message) {
    text +=
        (text.empty() ? "" : "\n") + world.name + ".toml:" + std::to_string(line) + ": " + message;
  };
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!overlap(world.rooms[i].rect, world.rooms[j].rect)) continue;
      complain(world.rooms[i].line, "room \"" + world.rooms[i].name + "\" overlaps room \"" +
                                        world.rooms[j].name + "\"");
    }
  }
  for (const DoorSpec& door : world.doors) {
    for (const RoomSpec& room : world.rooms) {
      if (!overlap(door.rect, room.rect)) continue;
      complain(door.line, "this door reaches into room \"" + room.name +
                              "\"; it fills the wall's thickness only");
    }
  }
  for (const BoxSpec& box : world.boxes) {
    const std::size_t room = room_of(world, box.rect);
    if (room == world.rooms.size()) {
      complain(box.line, "this box lies in no room; it must lie within one");
    } else if (world.rooms[room].ceiling_m - box.drop_m < 1.5) {
      complain(box.line, "this box hangs below 1.5 m; drop_m is too large");
    }
  }
  if (!text.empty()) return Error{text};
  return {};
}

void sort_and_merge(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const auto same = [](double a, double b) { return b - a < kSameEdge_m; };
  values.erase(std::unique(values.begin(), values.end(), same), values.end());
}

std::size_t cell_of(const std::vector<double>& edges, double value) {
  const auto after = std::upper_bound(edges.begin(), edges.end(), value);
  const auto index = std::distance(edges.begin(), after) - 1;
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(index, 0, static_cast<std::ptrdiff_t>(edges.size()) - 2));
}

}  // namespace

std::size_t FloorPlan::column(double x) const {
  return cell_of(xs_, x);
}
std::size_t FloorPlan::row(double y) const {
  return cell_of(ys_, y);
}

// Five facets in the order of FacetPart; returns the id of the horizontal one.
FacetId FloorPlan::add_facets(FacetOwner owner, std::size_t index, const Rect& rect,
                              double horizontal_z, double side_z0, double side_z1) {
  const auto first = static_cast<FacetId>(facets_.size());
  const auto f = [](double v) { return static_cast<float>(v); };
  const float z0 = f(side_z0);
  const float z1 = f(side_z1);
  const float x0 = f(rect.x0), x1 = f(rect.x1), y0 = f(rect.y0), y1 = f(rect.y1);
  facets_.push_back({2, f(horizontal_z), x0, x1, y0, y1, owner, index, FacetPart::kHorizontal});
  facets_.push_back({0, x0, y0, y1, z0, z1, owner, index, FacetPart::kWest});
  facets_.push_back({0, x1, y0, y1, z0, z1, owner, index, FacetPart::kEast});
  facets_.push_back({1, y0, x0, x1, z0, z1, owner, index, FacetPart::kSouth});
  facets_.push_back({1, y1, x0, x1, z0, z1, owner, index, FacetPart::kNorth});
  return first;
}

void FloorPlan::collect_edges(const WorldFile& world) {
  const auto add = [this](const Rect& rect) {
    xs_.insert(xs_.end(), {rect.x0, rect.x1});
    ys_.insert(ys_.end(), {rect.y0, rect.y1});
  };
  for (const RoomSpec& room : world.rooms) add(room.rect);
  for (const DoorSpec& door : world.doors) add(door.rect);
  for (const BoxSpec& box : world.boxes) add(box.rect);
  sort_and_merge(xs_);
  sort_and_merge(ys_);
  // A rim of solid cells, so that a walk from within always ends at a wall.
  xs_.insert(xs_.begin(), xs_.front() - 1.0);
  xs_.push_back(xs_.back() + 1.0);
  ys_.insert(ys_.begin(), ys_.front() - 1.0);
  ys_.push_back(ys_.back() + 1.0);
}

void FloorPlan::fill_cells(const Rect& rect, double height, FacetId first, bool is_box) {
  const std::size_t columns = xs_.size() - 1;
  for (std::size_t j = 0; j + 1 < ys_.size(); ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      if (!rect.contains(0.5 * (xs_[i] + xs_[i + 1]), 0.5 * (ys_[j] + ys_[j + 1]))) continue;
      Cell& cell = cells_[j * columns + i];
      const auto h = static_cast<float>(height);
      const auto side = static_cast<FacetId>(first + 1);
      if (!is_box) {
        cell = {h, first, side, kNoFacet};
      } else if (h < cell.height) {
        cell.height = h;
        cell.ceiling = first;
        cell.box = side;
      }
    }
  }
}

// A wall is open where a door or another room begins beyond it.
void FloorPlan::cut_holes(const WorldFile& world) {
  const auto cut = [this](Facet& wall, const Rect& r, double height) {
    const bool low_side = wall.part == FacetPart::kWest || wall.part == FacetPart::kSouth;
    const bool along_y = wall.axis == 0;
    const double edge = along_y ? (low_side ? r.x1 : r.x0) : (low_side ? r.y1 : r.y0);
    const auto a0 = static_cast<float>(along_y ? r.y0 : r.x0);
    const auto a1 = static_cast<float>(along_y ? r.y1 : r.x1);
    if (std::abs(edge - static_cast<double>(wall.offset)) > 1e-4) return;
    if (a1 <= wall.a0 || a0 >= wall.a1) return;
    holes_.push_back({a0, a1, -1.0F, static_cast<float>(height)});
    ++wall.hole_count;
  };
  for (Facet& wall : facets_) {
    wall.first_hole = static_cast<std::uint32_t>(holes_.size());
    if (wall.owner != FacetOwner::kRoom || wall.axis == 2) continue;
    for (const DoorSpec& door : world.doors) cut(wall, door.rect, door.height_m);
    for (const RoomSpec& room : world.rooms) cut(wall, room.rect, room.ceiling_m);
  }
}

Result<FloorPlan> FloorPlan::build(const WorldFile& world) {
  if (const Status checked = check(world); !checked) return checked.error();
  if (5 * (world.rooms.size() + world.doors.size() + world.boxes.size()) > kMaxFacets) {
    return Error{world.name + ": too many rooms, doors and boxes"};
  }
  FloorPlan plan;
  plan.collect_edges(world);
  plan.cells_.resize((plan.xs_.size() - 1) * (plan.ys_.size() - 1));
  const auto f = [](double v) { return static_cast<float>(v); };
  plan.facets_.push_back({2, 0.0F, f(plan.xs_.front()), f(plan.xs_.back()), f(plan.ys_.front()),
                          f(plan.ys_.back()), FacetOwner::kFloor, 0, FacetPart::kHorizontal});
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    const RoomSpec& room = world.rooms[i];
    const FacetId first =
        plan.add_facets(FacetOwner::kRoom, i, room.rect, room.ceiling_m, 0.0, room.ceiling_m);
    plan.fill_cells(room.rect, room.ceiling_m, first, false);
  }
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    const DoorSpec& door = world.doors[i];
    const FacetId first =
        plan.add_facets(FacetOwner::kDoor, i, door.rect, door.height_m, 0.0, door.height_m);
    plan.fill_cells(door.rect, door.height_m, first, false);
  }
  for (std::size_t i = 0; i < world.boxes.size(); ++i) {
    const BoxSpec& box = world.boxes[i];
    const double ceiling = world.rooms[room_of(world, box.rect)].ceiling_m;
    const FacetId first = plan.add_facets(FacetOwner::kBox, i, box.rect, ceiling - box.drop_m,
                                          ceiling - box.drop_m, ceiling);
    plan.fill_cells(box.rect, ceiling - box.drop_m, first, true);
  }
  plan.cut_holes(world);
  return plan;
}

bool FloorPlan::is_free(const Eigen::Vector2d& centre, double radius_m) const {
  constexpr int kRays = 16;
  for (int i = -1; i < kRays; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kRays;
    const double r = i < 0 ? 0.0 : radius_m;
    const double x = centre.x() + r * std::cos(angle);
    const double y = centre.y() + r * std::sin(angle);
    if (cell(column(x), row(y)).height <= 0.0F) return false;
  }
  return true;
}

}  // namespace zenith::sim
