#include "sim/walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zenith::sim {
namespace {

bool clear_of(const std::vector<Opening>& openings, double a0, double a1) {
  return std::none_of(openings.begin(), openings.end(),
                      [&](const Opening& o) { return a0 < o.a1 + 0.15 && a1 > o.a0 - 0.15; });
}

void paint_poster(Canvas& canvas, const Rect& r, Random& random) {
  canvas.rect({r.x0 + 0.01, r.y0 - 0.015, r.x1 + 0.012, r.y1}, shade(0.82));
  canvas.rect(r, paint(random.uniform(0.55, 0.92)));
  const int blocks = 2 + static_cast<int>(random.below(4));
  for (int i = 0; i < blocks; ++i) {
    const double x = random.uniform(r.x0 + 0.03, r.x1 - 0.12);
    const double y = random.uniform(r.y0 + 0.03, r.y1 - 0.10);
    const double w = random.uniform(0.06, std::max(0.07, r.x1 - x - 0.03));
    const double h = random.uniform(0.05, std::max(0.06, r.y1 - y - 0.03));
    const Rect block = {x, y, std::min(x + w, r.x1 - 0.02), std::min(y + h, r.y1 - 0.02)};
    canvas.rect(block, paint(random.uniform(0.10, 0.75)));
  }
  for (double y = r.y0 + 0.05; y < r.y0 + 0.4 * r.depth(); y += 0.035) {
    canvas.rect({r.x0 + 0.04, y, random.uniform(0.6, 0.95) * r.width() + r.x0, y + 0.012},
                paint(0.30));
  }
  canvas.frame(r, 0.012, paint(random.uniform(0.12, 0.6)));
}

void paint_opening(Canvas& canvas, const Opening& door, Random& random) {
  const double frame = 0.07;
  const double value = random.uniform(0.25, 0.50);
  // Also over the opening itself, so that coarse mip levels do not mix wall paint into its edge.
  canvas.rect({door.a0 - frame, 0.0, door.a1 + frame, door.height_m + frame}, paint(value));
  // The room's number beside it, a switch below.
  const double plate = door.a1 + frame + random.uniform(0.10, 0.25);
  canvas.rect({plate, 1.50, plate + 0.16, 1.66}, paint(random.uniform(0.2, 0.9)));
  for (int i = 0; i < 3; ++i) {
    const double x = plate + 0.02 + 0.042 * i;
    canvas.rect({x, 1.55, x + 0.022, 1.55 + random.uniform(0.03, 0.08)}, paint(0.10));
  }
  canvas.rect({plate, 1.05, plate + 0.08, 1.13}, paint(0.90));
}

// A closed cupboard or service door, flush with the wall.
void paint_panel(Canvas& canvas, double a, Random& random) {
  const double w = random.uniform(0.5, 0.9);
  const double top = random.uniform(1.9, 2.15);
  canvas.rect({a, 0.0, a + w, top}, paint(random.uniform(0.30, 0.65)));
  canvas.frame({a, 0.0, a + w, top}, 0.03, shade(0.6));
  canvas.disc(a + w - 0.08, 1.05, 0.02, paint(0.15));
}

void paint_vertical_pipe(Canvas& canvas, double a, Random& random) {
  const double w = random.uniform(0.03, 0.08);
  const double value = random.uniform(0.35, 0.75);
  const double h = canvas.height_m();
  canvas.rect({a, 0.0, a + w, h}, paint(value));
  canvas.rect({a, 0.0, a + 0.3 * w, h}, shade(0.7));
  canvas.rect({a + w, 0.0, a + 1.3 * w, h}, shade(0.8));
  for (double z = random.uniform(0.2, 0.9); z < h; z += random.uniform(0.7, 1.0)) {
    canvas.rect({a - 0.012, z, a + w + 0.012, z + 0.03}, paint(0.28));
  }
}

void paint_clock(Canvas& canvas, double a, double z, Random& random) {
  canvas.disc(a, z, 0.15, paint(0.12));
  canvas.disc(a, z, 0.135, paint(0.90));
  for (const double length : {0.11, 0.07}) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    canvas.line(a, z, a + length * std::cos(angle), z + length * std::sin(angle), 0.014,
                paint(0.08));
  }
}

void paint_trunking(Canvas& canvas, Random& random) {
  const double z = canvas.height_m() - random.uniform(0.15, 0.45);
  const double h = random.uniform(0.05, 0.11);
  const double a0 = random.uniform(0.0, 0.3) * canvas.width_m();
  const double a1 = random.uniform(0.6, 1.0) * canvas.width_m();
  canvas.rect({a0, z - 0.02, a1, z}, shade(0.85));
  canvas.rect({a0, z, a1, z + h}, paint(0.85));
  canvas.frame({a0, z, a1, z + h}, 0.008, shade(0.7));
  for (double a = a0 + 2.0; a < a1; a += 2.0) canvas.rect({a, z, a + 0.01, z + h}, shade(0.5));
}

void paint_decoration(Canvas& canvas, const std::vector<Opening>& openings, double clutter,
                      Random& random) {
  const int tries = static_cast<int>(std::lround(0.9 * canvas.width_m() * clutter));
  for (int i = 0; i < tries; ++i) {
    const double a = random.uniform(0.1, std::max(0.2, canvas.width_m() - 0.9));
    if (!clear_of(openings, a, a + 0.9)) continue;
    const double luck = random.uniform();
    if (luck < 0.48) {
      const double w = random.uniform(0.3, 0.8);
      const double z = random.uniform(1.25, 1.6);
      paint_poster(canvas, {a, z, a + w, z + random.uniform(0.4, 0.7)}, random);
    } else if (luck < 0.62) {
      paint_panel(canvas, a, random);
    } else if (luck < 0.76) {
      paint_vertical_pipe(canvas, a + 0.2, random);
    } else if (luck < 0.86) {
      paint_clock(canvas, a + 0.4, random.uniform(1.9, 2.2), random);
    } else {
      canvas.blob(a + 0.3, random.uniform(1.2, 2.3), random.uniform(0.04, 0.14), 0.02,
                  shade(random.uniform(0.75, 0.92)), random);
    }
  }
}

}  // namespace

std::vector<LitSign> paint_wall(Canvas& canvas, const RoomSpec& room,
                                const std::vector<Opening>& openings, Random& random) {
  std::vector<LitSign> signs;
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  if (room.walls == WallStyle::kBlank) {
    canvas.rect({0.0, 0.0, w, h}, paint(0.70));
    canvas.mottle(1.5, 0.006, random);
    return signs;
  }
  if (room.walls == WallStyle::kPeriodic) {
    canvas.rect({0.0, 0.0, w, h}, paint(0.66));
    canvas.rect({0.0, 0.95, w, 1.05}, paint(0.45));
    for (double a = 0.0; a < w; a += 2.4) canvas.rect({a, 0.0, a + 0.05, h}, paint(0.50));
    return signs;
  }
  canvas.rect({0.0, 0.0, w, h}, paint(random.uniform(0.55, 0.74)));
  if (random.uniform() < 0.5) canvas.rect({0.0, 0.0, w, 1.02}, paint(random.uniform(0.3, 0.55)));
  canvas.mottle(0.8, 0.025, random);
  canvas.mottle(0.06, 0.020, random);
  canvas.pores(0.06, random);
  canvas.rect({0.0, h - 0.03, w, h}, paint(0.80));
  if (room.clutter > 0.0 && random.uniform() < 0.45) paint_trunking(canvas, random);
  paint_decoration(canvas, openings, room.clutter, random);
  for (const Opening& door : openings) {
    paint_opening(canvas, door, random);
    const double z = door.height_m + 0.14;
    const double middle = 0.5 * (door.a0 + door.a1);
    if (h - z < 0.24 || random.uniform() > 0.5 * room.clutter) continue;
    signs.push_back({{middle - 0.18, z, middle + 0.18, z + 0.18}, random.uniform() < 0.5});
  }
  return signs;
}

void paint_sign(Canvas& canvas, const LitSign& sign) {
  const Rect& r = sign.rect;
  canvas.rect(r, paint(0.55));
  const auto x = [&](double u) { return sign.mirrored ? r.x1 - u : r.x0 + u; };
  const auto bar = [&](double u0, double v0, double u1, double v1) {
    const double xa = x(u0);
    const double xb = x(u1);
    canvas.rect({std::min(xa, xb), r.y0 + v0, std::max(xa, xb), r.y0 + v1}, paint(1.5));
  };
  bar(0.04, 0.07, 0.14, 0.11);  // arrow's shaft
  bar(0.14, 0.04, 0.17, 0.14);  // arrow's head
  bar(0.22, 0.03, 0.30, 0.15);  // the door
  canvas.frame(r, 0.012, paint(0.9));
}

void paint_door_reveal(Canvas& canvas) {
  canvas.rect({0.0, 0.0, canvas.width_m(), canvas.height_m()}, paint(0.48));
  canvas.frame({0.0, 0.0, canvas.width_m(), canvas.height_m()}, 0.02, paint(0.36));
}

void paint_box(Canvas& canvas, BoxKind kind, bool underside, bool along_a, Random& random) {
  const double w = canvas.width_m();
  const double h = canvas.height_m();
  const double length = along_a ? w : h;
  // A stripe across the box's length at distance `o` along it.
  const auto across = [&](double o, double line_m, const Ink& ink) {
    along_a ? canvas.rect({o, 0.0, o + line_m, h}, ink) : canvas.rect({0.0, o, w, o + line_m}, ink);
  };
  switch (kind) {
    case BoxKind::kBeam:
      canvas.rect({0.0, 0.0, w, h}, paint(underside ? 0.62 : 0.56));
      canvas.mottle(0.4, 0.05, random);
      canvas.mottle(0.05, 0.04, random);
      for (double o = random.uniform(0.1, 0.8); o < length; o += random.uniform(0.4, 1.5)) {
        const double x = along_a ? o : random.uniform(0.0, w);
        const double y = along_a ? random.uniform(0.0, h) : o;
        canvas.blob(x, y, random.uniform(0.015, 0.05), 0.01, shade(random.uniform(0.55, 0.85)),
                    random);
      }
      break;
    case BoxKind::kDuct:
      canvas.rect({0.0, 0.0, w, h}, paint(underside ? 0.50 : 0.58));
      canvas.mottle(0.5, 0.06, random);
      canvas.mottle(0.07, 0.05, random);
      for (double o = random.uniform(0.2, 1.0); o < length; o += 1.2) {
        across(o, 0.03, paint(0.34));
        across(o + 0.03, 0.015, paint(0.72));
      }
      break;
    case BoxKind::kPipe:
      canvas.rect({0.0, 0.0, w, h}, paint(underside ? 0.42 : 0.55));
      if (along_a) {
        canvas.rect({0.0, 0.3 * h, w, 0.6 * h}, shade(1.35));
      } else {
        canvas.rect({0.3 * w, 0.0, 0.6 * w, h}, shade(1.35));
      }
      for (double o = random.uniform(0.2, 1.0); o < length; o += random.uniform(1.4, 2.2)) {
        across(o, 0.05, paint(0.25));
      }
      break;
    case BoxKind::kTray:
      canvas.rect({0.0, 0.0, w, h}, paint(underside ? 0.20 : 0.55));
      if (!underside) break;
      for (double o = 0.04; o < (along_a ? h : w); o += random.uniform(0.03, 0.07)) {
        const double v = random.uniform(0.08, 0.45);
        along_a ? canvas.rect({0.0, o, w, o + 0.02}, paint(v))
                : canvas.rect({o, 0.0, o + 0.02, h}, paint(v));
      }
      for (double o = 0.1; o < length; o += 0.3) across(o, 0.025, paint(0.66));
      break;
  }
}

void paint_floor(Canvas& canvas, Random& random) {
  canvas.rect({0.0, 0.0, canvas.width_m(), canvas.height_m()}, paint(0.26));
  canvas.mottle(1.0, 0.08, random);
  canvas.mottle(0.15, 0.06, random);
}

}  // namespace zenith::sim
