#include "sim/scene.h"

#include <algorithm>
#include <cmath>

#include "sim/canvas.h"
#include "sim/ceiling.h"
#include "sim/seed.h"
#include "sim/walls.h"

namespace zenith::sim {
namespace {

constexpr double kTexel_m = 0.01;
constexpr double kFloorTexel_m = 0.05;
constexpr double kLightStep_m = 0.1;

Eigen::Vector3d point_on(const Facet& facet, double a, double b) {
  if (facet.axis == 2) return {a, b, facet.offset};
  if (facet.axis == 0) return {facet.offset, a, b};
  return {a, facet.offset, b};
}

// Multiplies by the light, computed on a coarse grid and interpolated.
void apply_light(Canvas& canvas, const Facet& facet, const RoomLight& light) {
  const int nx = static_cast<int>(canvas.width_m() / kLightStep_m) + 2;
  const int ny = static_cast<int>(canvas.height_m() / kLightStep_m) + 2;
  std::vector<float> grid(static_cast<std::size_t>(nx) * ny);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const double a = std::min(facet.a0 + i * kLightStep_m, static_cast<double>(facet.a1));
      const double b = std::min(facet.b0 + j * kLightStep_m, static_cast<double>(facet.b1));
      grid[static_cast<std::size_t>(j) * nx + i] =
          static_cast<float>(light.at(point_on(facet, a, b), facet.axis));
    }
  }
  const double per_texel = canvas.texel_m() / kLightStep_m;
  for (int j = 0; j < canvas.rows(); ++j) {
    float* values = canvas.row(j);
    const double y = (j + 0.5) * per_texel;
    const int gy = std::min(static_cast<int>(y), ny - 2);
    const auto fy = static_cast<float>(y - gy);
    const float* top = grid.data() + static_cast<std::size_t>(gy) * nx;
    const float* bottom = top + nx;
    for (int i = 0; i < canvas.columns(); ++i) {
      const double x = (i + 0.5) * per_texel;
      const int gx = std::min(static_cast<int>(x), nx - 2);
      const auto fx = static_cast<float>(x - gx);
      const float a = top[gx] + fx * (top[gx + 1] - top[gx]);
      const float b = bottom[gx] + fx * (bottom[gx + 1] - bottom[gx]);
      values[i] *= a + fy * (b - a);
    }
  }
}

// The doors that open through this side of the room.
std::vector<Opening> openings_of(const WorldFile& world, const Facet& wall) {
  std::vector<Opening> openings;
  for (const DoorSpec& door : world.doors) {
    const Rect& r = door.rect;
    const bool along_y = wall.axis == 0;
    const double near_edge = along_y ? r.x0 : r.y0;
    const double far_edge = along_y ? r.x1 : r.y1;
    const double a0 = along_y ? r.y0 : r.x0;
    const double a1 = along_y ? r.y1 : r.x1;
    const double offset = wall.offset;
    const bool touches = std::abs(near_edge - offset) < 1e-3 || std::abs(far_edge - offset) < 1e-3;
    if (!touches || a1 <= wall.a0 || a0 >= wall.a1) continue;
    openings.push_back({a0 - wall.a0, a1 - wall.a0, door.height_m});
  }
  return openings;
}

std::size_t room_around(const WorldFile& world, const Rect& rect) {
  const double x = 0.5 * (rect.x0 + rect.x1);
  const double y = 0.5 * (rect.y0 + rect.y1);
  const auto at = std::find_if(world.rooms.begin(), world.rooms.end(),
                               [&](const RoomSpec& room) { return room.rect.contains(x, y); });
  return static_cast<std::size_t>(std::distance(world.rooms.begin(), at));
}

struct Painter {
  const WorldFile& world;
  std::uint64_t seed;
  bool lamps_on;
  std::vector<RoomLayout> layouts;
  std::vector<RoomLight> lights;

  Texture operator()(const Facet& facet, std::size_t id) const {
    const double texel = facet.owner == FacetOwner::kFloor ? kFloorTexel_m : kTexel_m;
    Canvas canvas(static_cast<double>(facet.a1) - facet.a0,
                  static_cast<double>(facet.b1) - facet.b0, texel, 0.6);
    Random random = random_stream(seed, "facet", id);
    switch (facet.owner) {
      case FacetOwner::kFloor:
        paint_floor(canvas, random);
        break;
      case FacetOwner::kDoor:
        paint_door_reveal(canvas);
        break;
      case FacetOwner::kRoom:
        paint_room(canvas, facet, random);
        break;
      case FacetOwner::kBox:
        paint_hanging(canvas, facet, random);
        break;
    }
    return canvas.texture();
  }

  void paint_room(Canvas& canvas, const Facet& facet, Random& random) const {
    const RoomSpec& room = world.rooms[facet.index];
    if (facet.part == FacetPart::kHorizontal) {
      paint_ceiling(canvas, room, layouts[facet.index], lamps_on, seed, facet.index);
      apply_light(canvas, facet, lights[facet.index]);
      if (lamps_on) paint_lit_lamps(canvas, room, layouts[facet.index]);
      return;
    }
    const auto signs = paint_wall(canvas, room, openings_of(world, facet), random);
    apply_light(canvas, facet, lights[facet.index]);
    for (const LitSign& sign : signs) paint_sign(canvas, sign);
  }

  void paint_hanging(Canvas& canvas, const Facet& facet, Random& random) const {
    const BoxSpec& box = world.boxes[facet.index];
    const bool long_x = box.rect.width() >= box.rect.depth();
    const bool underside = facet.part == FacetPart::kHorizontal;
    paint_box(canvas, box.kind, underside, underside ? long_x : true, random);
    apply_light(canvas, facet, lights[room_around(world, box.rect)]);
  }
};

}  // namespace

Scene::Scene(const WorldFile& world, const FloorPlan& plan, std::uint64_t seed, bool lamps_on) {
  Painter painter{world, seed, lamps_on, {}, {}};
  painter.layouts.reserve(world.rooms.size());  // the lights keep references
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    painter.layouts.push_back(lay_out_room(world.rooms[i], seed, i));
    painter.lights.emplace_back(world.rooms[i], painter.layouts[i], lamps_on, seed, i);
  }
  textures_.reserve(plan.facets().size());
  for (std::size_t i = 0; i < plan.facets().size(); ++i) {
    textures_.push_back(painter(plan.facets()[i], i));
  }
}

std::size_t Scene::bytes() const {
  std::size_t sum = 0;
  for (const Texture& texture : textures_) sum += texture.bytes();
  return sum;
}

}  // namespace zenith::sim
