#include "sim/ceiling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/fixtures.h"
#include "sim/seed.h"

namespace zenith::sim {
namespace {

constexpr double kBar_m = 0.024;  // the visible flange of a suspension bar

double first_line(double grid, double low) {
  return grid + kTile_m * std::floor((low - grid) / kTile_m) - low;
}

// Mineral fibre: short dark fissures of random direction.
void paint_fissures(Canvas& canvas, const Rect& tile, Random& random) {
  const int count = 10 + static_cast<int>(random.below(8));
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(tile.x0 + 0.03, tile.x1 - 0.03);
    const double y = random.uniform(tile.y0 + 0.03, tile.y1 - 0.03);
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double length = random.uniform(0.008, 0.040);
    canvas.line(x, y, x + length * std::cos(angle), y + length * std::sin(angle),
                random.uniform(0.003, 0.008), shade(random.uniform(0.62, 0.85)));
  }
}

void paint_tile(Canvas& canvas, const Rect& tile, double clutter, Random& random) {
  double value = 0.72 * (1.0 + 0.025 * random.normal());
  // A replaced tile is whiter, an old one yellower.
  const double luck = random.uniform();
  if (luck < 0.03 * clutter) value *= 1.10;
  if (luck > 1.0 - 0.03 * clutter) value *= 0.86;
  canvas.rect(tile, paint(value));
  paint_fissures(canvas, tile, random);
}

void paint_bars(Canvas& canvas, double gx, double gy, double value) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  const auto both = [&](double line_m, const Ink& ink) {
    for (double x = gx; x < w + 0.1; x += kTile_m) {
      canvas.rect({x - 0.5 * line_m, 0.0, x + 0.5 * line_m, h}, ink);
    }
    for (double y = gy; y < h + 0.1; y += kTile_m) {
      canvas.rect({0.0, y - 0.5 * line_m, w, y + 0.5 * line_m}, ink);
    }
  };
  // The joint's shadow on both sides, then the flange.
  both(kBar_m + 0.010, paint(0.50));
  both(kBar_m, paint(value));
}

void paint_tiles(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout, Random& random) {
  const double gx = first_line(layout.grid_x, room.rect.x0);
  const double gy = first_line(layout.grid_y, room.rect.y0);
  for (double y = gy; y < canvas.height_m(); y += kTile_m) {
    for (double x = gx; x < canvas.width_m(); x += kTile_m) {
      paint_tile(canvas, {x, y, x + kTile_m, y + kTile_m}, room.clutter, random);
    }
  }
  canvas.pores(0.25, random);
  paint_bars(canvas, gx, gy, 0.80);
}

void paint_periodic(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout) {
  const double gx = first_line(layout.grid_x, room.rect.x0);
  const double gy = first_line(layout.grid_y, room.rect.y0);
  canvas.rect({0.0, 0.0, canvas.width_m(), canvas.height_m()}, paint(0.72));
  // The same print on every tile.
  for (double y = gy; y < canvas.height_m(); y += kTile_m) {
    for (double x = gx; x < canvas.width_m(); x += kTile_m) {
      Random same(7);
      canvas.frame({x + 0.21, y + 0.21, x + 0.39, y + 0.39}, 0.03, paint(0.42));
      paint_fissures(canvas, {x, y, x + kTile_m, y + kTile_m}, same);
    }
  }
  paint_bars(canvas, gx, gy, 0.80);
}

void paint_crack(Canvas& canvas, Random& random) {
  double x = random.uniform(0.0, canvas.width_m());
  double y = random.uniform(0.0, canvas.height_m());
  double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const int pieces = 6 + static_cast<int>(random.below(14));
  for (int i = 0; i < pieces; ++i) {
    angle += random.uniform(-0.7, 0.7);
    const double length = random.uniform(0.05, 0.14);
    const double nx = x + length * std::cos(angle);
    const double ny = y + length * std::sin(angle);
    canvas.line(x, y, nx, ny, random.uniform(0.004, 0.009), shade(0.62));
    x = nx;
    y = ny;
  }
}

void paint_plaster(Canvas& canvas, const RoomSpec& room, Random& random) {
  const double area = canvas.width_m() * canvas.height_m();
  canvas.rect({0.0, 0.0, canvas.width_m(), canvas.height_m()}, paint(0.74));
  canvas.mottle(0.9, 0.035, random);
  canvas.mottle(0.13, 0.020, random);
  canvas.mottle(0.035, 0.018, random);
  const auto count = [&](double per_m2) {
    return static_cast<int>(std::lround(per_m2 * area * room.clutter));
  };
  for (int i = 0; i < count(0.16); ++i) paint_crack(canvas, random);
  for (int i = 0; i < count(0.30); ++i) {
    // Filled and repainted places.
    canvas.blob(random.uniform(0.0, canvas.width_m()), random.uniform(0.0, canvas.height_m()),
                random.uniform(0.04, 0.16), 0.01, shade(random.uniform(0.86, 1.12)), random);
  }
}

void paint_concrete(Canvas& canvas, const RoomSpec& room, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  canvas.rect({0.0, 0.0, w, h}, paint(0.50));
  canvas.mottle(1.1, 0.10, random);
  canvas.mottle(0.25, 0.07, random);
  canvas.mottle(0.05, 0.05, random);
  canvas.pores(0.45, random);
  const double ox = random.uniform(0.0, 1.2);
  const double oy = random.uniform(0.0, 2.4);
  for (double x = ox; x < w; x += 1.2) canvas.line(x, 0.0, x, h, 0.009, shade(0.68));
  for (double y = oy; y < h; y += 2.4) canvas.line(0.0, y, w, y, 0.009, shade(0.68));
  for (double y = oy - 1.8; y < h; y += 1.2) {
    for (double x = ox - 0.6; x < w; x += 1.2) canvas.disc(x, y, 0.018, shade(0.45));
  }
  const int spots = static_cast<int>(std::lround(0.5 * w * h * room.clutter));
  for (int i = 0; i < spots; ++i) {
    canvas.blob(random.uniform(0.0, w), random.uniform(0.0, h), random.uniform(0.02, 0.14), 0.02,
                shade(random.uniform(0.70, 1.22)), random);
  }
}

// A lamp that does not shine: a diffuser in a frame.
void paint_dark_lamp(Canvas& canvas, const Rect& r, bool round) {
  if (round) {
    canvas.disc(0.5 * (r.x0 + r.x1), 0.5 * (r.y0 + r.y1), 0.5 * r.width(), paint(0.55));
    canvas.disc(0.5 * (r.x0 + r.x1), 0.5 * (r.y0 + r.y1), 0.5 * r.width() - 0.03, paint(0.84));
    return;
  }
  canvas.rect(r, paint(0.46));
  const double rim = std::min(0.025, 0.2 * std::min(r.width(), r.depth()));
  canvas.rect({r.x0 + rim, r.y0 + rim, r.x1 - rim, r.y1 - rim}, paint(0.86));
}

Rect in_canvas(const Rect& r, const Rect& room) {
  return {r.x0 - room.x0, r.y0 - room.y0, r.x1 - room.x0, r.y1 - room.y0};
}

}  // namespace

void paint_ceiling(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout, bool lamps_on,
                   std::uint64_t seed, std::size_t index) {
  Random random = random_stream(seed, "ceiling", index);
  switch (room.ceiling) {
    case CeilingStyle::kTiles:
      paint_tiles(canvas, room, layout, random);
      break;
    case CeilingStyle::kPlaster:
      paint_plaster(canvas, room, random);
      break;
    case CeilingStyle::kConcrete:
      paint_concrete(canvas, room, random);
      break;
    case CeilingStyle::kPeriodic:
      paint_periodic(canvas, room, layout);
      break;
    case CeilingStyle::kBlank:
      canvas.rect({0.0, 0.0, canvas.width_m(), canvas.height_m()}, paint(0.74));
      canvas.mottle(1.5, 0.008, random);
      break;
  }
  paint_fixtures(canvas, room, layout, random);
  for (const Lamp& lamp : layout.lamps) {
    if (lamps_on && !lamp.dead) continue;
    paint_dark_lamp(canvas, in_canvas(lamp.rect, room.rect), lamp.round);
  }
}

void paint_lit_lamps(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout) {
  for (const Lamp& lamp : layout.lamps) {
    if (lamp.dead) continue;
    const Rect r = in_canvas(lamp.rect, room.rect);
    const double rim = room.lamps == LampStyle::kTubes ? 0.0 : 0.020;
    const Rect inner = {r.x0 + rim, r.y0 + rim, r.x1 - rim, r.y1 - rim};
    if (lamp.round) {
      canvas.disc(0.5 * (r.x0 + r.x1), 0.5 * (r.y0 + r.y1), 0.5 * inner.width(),
                  paint(kLampRadiance));
    } else {
      canvas.rect(inner, paint(kLampRadiance));
    }
  }
}

}  // namespace zenith::sim
