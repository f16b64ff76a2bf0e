#include "sim/fixtures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zenith::sim {
namespace {

// Four-way diffuser: nested squares; a louvre: parallel slots.
void paint_vent(Canvas& canvas, double x, double y, double size, Random& random) {
  const double h = 0.5 * size;
  canvas.rect({x - h, y - h, x + h, y + h}, paint(0.78));
  if (random.uniform() < 0.6) {
    for (double r = h - 0.05; r > 0.04; r -= 0.065) {
      canvas.frame({x - r, y - r, x + r, y + r}, 0.028, paint(0.22));
    }
  } else {
    const bool along = random.uniform() < 0.5;
    for (double o = -h + 0.06; o < h - 0.05; o += 0.06) {
      along ? canvas.rect({x - h + 0.05, y + o, x + h - 0.05, y + o + 0.026}, paint(0.25))
            : canvas.rect({x + o, y - h + 0.05, x + o + 0.026, y + h - 0.05}, paint(0.25));
    }
  }
}

void paint_sprinkler(Canvas& canvas, double x, double y) {
  canvas.disc(x, y, 0.045, paint(0.86));
  canvas.ring(x, y, 0.047, 0.008, shade(0.70));
  canvas.disc(x, y, 0.018, paint(0.18));
}

void paint_detector(Canvas& canvas, double x, double y, Random& random) {
  const double r = random.uniform(0.05, 0.065);
  canvas.disc(x + 0.008, y - 0.006, r + 0.012, shade(0.72));
  canvas.disc(x, y, r, paint(0.90));
  canvas.ring(x, y, 0.6 * r, 0.010, shade(0.55));
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  canvas.disc(x + 0.7 * r * std::cos(angle), y + 0.7 * r * std::sin(angle), 0.008, paint(0.10));
}

void paint_speaker(Canvas& canvas, double x, double y) {
  canvas.disc(x, y, 0.11, paint(0.88));
  canvas.disc(x, y, 0.085, paint(0.52));
  canvas.disc(x, y, 0.03, paint(0.62));
}

void paint_hatch(Canvas& canvas, double x, double y, double size) {
  const Rect r = {x - 0.5 * size, y - 0.5 * size, x + 0.5 * size, y + 0.5 * size};
  canvas.rect(r, paint(0.80));
  canvas.frame(r, 0.012, paint(0.38));
  canvas.disc(x + 0.36 * size, y, 0.014, paint(0.25));
}

void paint_water_stain(Canvas& canvas, double x, double y, Random& random) {
  const double r = random.uniform(0.08, 0.28);
  canvas.blob(x, y, r, 0.03, shade(random.uniform(0.74, 0.88)), random);
  canvas.blob(x + random.uniform(-0.3, 0.3) * r, y + random.uniform(-0.3, 0.3) * r,
              r * random.uniform(0.4, 0.8), 0.02, shade(random.uniform(0.90, 1.15)), random);
}

void paint_scuff(Canvas& canvas, double x, double y, Random& random) {
  const int spots = 1 + static_cast<int>(random.below(4));
  for (int i = 0; i < spots; ++i) {
    canvas.blob(x + random.uniform(-0.10, 0.10), y + random.uniform(-0.10, 0.10),
                random.uniform(0.012, 0.035), 0.008, shade(random.uniform(0.45, 0.80)), random);
  }
}

// A cable clipped to the ceiling: runs straight, bends at right angles.
void paint_cable(Canvas& canvas, double x, double y, Random& random) {
  bool along_x = random.uniform() < 0.5;
  const int pieces = 2 + static_cast<int>(random.below(3));
  for (int i = 0; i < pieces; ++i) {
    const double length = random.uniform(0.4, 1.6) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    const double nx = along_x ? x + length : x;
    const double ny = along_x ? y : y + length;
    canvas.line(x, y, nx, ny, 0.014, paint(0.34));
    x = nx;
    y = ny;
    along_x = !along_x;
  }
  canvas.rect({x - 0.05, y - 0.05, x + 0.05, y + 0.05}, paint(0.88));
  canvas.frame({x - 0.05, y - 0.05, x + 0.05, y + 0.05}, 0.01, paint(0.45));
}

bool under_lamp(const RoomLayout& layout, double x, double y) {
  constexpr double kClear_m = 0.25;
  return std::any_of(layout.lamps.begin(), layout.lamps.end(), [&](const Lamp& lamp) {
    const Rect& r = lamp.rect;
    return x > r.x0 - kClear_m && x < r.x1 + kClear_m && y > r.y0 - kClear_m && y < r.y1 + kClear_m;
  });
}

}  // namespace

void paint_fixtures(Canvas& canvas, const RoomSpec& room, const RoomLayout& layout,
                    Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  const double amount = w * h * room.clutter;
  const bool grid = room.ceiling == CeilingStyle::kTiles || room.ceiling == CeilingStyle::kPeriodic;
  // In a grid ceiling, things sit in the middle of a tile.
  const auto in_grid = [&](double v, double line) {
    return grid ? line + kTile_m * (std::floor((v - line) / kTile_m) + 0.5) : v;
  };
  const auto each = [&](double per_m2, auto&& draw) {
    const double wanted = per_m2 * amount;
    const int count = static_cast<int>(wanted) + (random.uniform() < wanted - std::floor(wanted));
    for (int i = 0; i < count; ++i) {
      const double x = random.uniform(0.15, std::max(0.16, w - 0.15));
      const double y = random.uniform(0.15, std::max(0.16, h - 0.15));
      const double gx = in_grid(x, layout.grid_x - room.rect.x0);
      const double gy = in_grid(y, layout.grid_y - room.rect.y0);
      if (!under_lamp(layout, room.rect.x0 + gx, room.rect.y0 + gy)) draw(x, y, gx, gy);
    }
  };
  const double size = grid ? kTile_m - 0.03 : 0.45;
  each(0.07, [&](double x, double y, double, double) { paint_water_stain(canvas, x, y, random); });
  each(0.30, [&](double x, double y, double, double) { paint_scuff(canvas, x, y, random); });
  each(0.05, [&](double, double, double x, double y) { paint_vent(canvas, x, y, size, random); });
  each(0.02, [&](double, double, double x, double y) { paint_hatch(canvas, x, y, size); });
  each(0.03, [&](double, double, double x, double y) { paint_speaker(canvas, x, y); });
  each(0.09, [&](double, double, double x, double y) { paint_sprinkler(canvas, x, y); });
  each(0.06, [&](double, double, double x, double y) { paint_detector(canvas, x, y, random); });
  if (grid) return;
  each(0.05, [&](double x, double y, double, double) { paint_cable(canvas, x, y, random); });
}

}  // namespace zenith::sim
