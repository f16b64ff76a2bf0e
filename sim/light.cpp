#include "sim/light.h"

#include <algorithm>
#include <cmath>

#include "sim/seed.h"

namespace zenith::sim {
namespace {

constexpr double kBase = 0.55;
constexpr double kMeanFromLamps = 0.45;
constexpr double kSoft_m = 0.9;
constexpr double kOcclusion_m = 0.15;

double lamp_spacing(LampStyle style) {
  switch (style) {
    case LampStyle::kPanels:
      return 2.4;
    case LampStyle::kTubes:
      return 2.7;
    case LampStyle::kRound:
      return 1.9;
    case LampStyle::kNone:
      break;
  }
  return 1e9;
}

Rect lamp_rect(LampStyle style, bool along_x, bool large, double x, double y) {
  double w = 0.30;
  double d = 0.30;
  if (style == LampStyle::kPanels) {
    w = large ? 2.0 * kTile_m : kTile_m;
    d = kTile_m;
  } else if (style == LampStyle::kTubes) {
    w = 1.25;
    d = 0.14;
  }
  if (!along_x) std::swap(w, d);
  return {x - 0.5 * w, y - 0.5 * d, x + 0.5 * w, y + 0.5 * d};
}

// The nearest place where the lamp's corner lies on the grid.
Rect snapped(const Rect& r, const RoomLayout& layout) {
  const auto shift = [](double low, double grid) {
    return grid + kTile_m * std::round((low - grid) / kTile_m) - low;
  };
  const double dx = shift(r.x0, layout.grid_x);
  const double dy = shift(r.y0, layout.grid_y);
  return {r.x0 + dx, r.y0 + dy, r.x1 + dx, r.y1 + dy};
}

bool fits(const Rect& r, const Rect& room) {
  return r.x0 >= room.x0 && r.x1 <= room.x1 && r.y0 >= room.y0 && r.y1 <= room.y1;
}

}  // namespace

RoomLayout lay_out_room(const RoomSpec& room, std::uint64_t seed, std::size_t index) {
  const bool periodic = room.ceiling == CeilingStyle::kPeriodic;
  Random random = random_stream(seed, "layout", index);
  RoomLayout layout;
  layout.grid_x = room.rect.x0 + (periodic ? 0.0 : random.uniform(0.0, kTile_m));
  layout.grid_y = room.rect.y0 + (periodic ? 0.0 : random.uniform(0.0, kTile_m));
  if (room.lamps == LampStyle::kNone) return layout;
  const double spacing = lamp_spacing(room.lamps);
  const bool along_x = room.rect.width() >= room.rect.depth();
  const bool large = !periodic && random.uniform() < 0.5;
  const auto count = [&](double length) {
    return std::max(1, static_cast<int>(std::lround(length / spacing)));
  };
  const int nx = count(room.rect.width());
  const int ny = count(room.rect.depth());
  const double dx = periodic ? spacing : room.rect.width() / nx;
  const double dy = room.rect.depth() / ny;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      // Fitters are not surveyors: surface lamps are off by a few centimetres.
      const double slack = periodic || room.lamps == LampStyle::kPanels ? 0.0 : 0.05;
      const double x = room.rect.x0 + (i + 0.5) * dx + random.uniform(-slack, slack);
      const double y = room.rect.y0 + (j + 0.5) * dy + random.uniform(-slack, slack);
      Lamp lamp;
      lamp.rect = lamp_rect(room.lamps, along_x, large, x, y);
      lamp.round = room.lamps == LampStyle::kRound;
      if (room.lamps == LampStyle::kPanels) lamp.rect = snapped(lamp.rect, layout);
      lamp.dead = !periodic && room.clutter > 0.0 && random.uniform() < 0.10;
      if (fits(lamp.rect, room.rect)) layout.lamps.push_back(lamp);
    }
  }
  return layout;
}

RoomLight::RoomLight(const RoomSpec& room, const RoomLayout& layout, bool lamps_on,
                     std::uint64_t seed, std::size_t index)
    : room_(room), layout_(layout), lamps_on_(lamps_on) {
  Random random = random_stream(seed, "window", index);
  window_side_ = static_cast<int>(random.below(4));
  // The gain makes the sum over the lamps 1 on average at half height.
  constexpr int kProbes = 12;
  double sum = 0.0;
  for (int j = 0; j < kProbes; ++j) {
    for (int i = 0; i < kProbes; ++i) {
      sum +=
          lamps_at({room.rect.x0 + (i + 0.5) / kProbes * room.rect.width(),
                    room.rect.y0 + (j + 0.5) / kProbes * room.rect.depth(), 0.5 * room.ceiling_m});
    }
  }
  gain_ = sum > 0.0 ? kProbes * kProbes / sum : 0.0;
}

double RoomLight::lamps_at(const Eigen::Vector3d& point) const {
  double sum = 0.0;
  for (const Lamp& lamp : layout_.lamps) {
    if (lamp.dead) continue;
    const Rect& r = lamp.rect;
    const double dx = point.x() - 0.5 * (r.x0 + r.x1);
    const double dy = point.y() - 0.5 * (r.y0 + r.y1);
    const double dz = point.z() - room_.ceiling_m;
    sum += r.width() * r.depth() / (dx * dx + dy * dy + dz * dz + kSoft_m * kSoft_m);
  }
  return sum;
}

double RoomLight::at(const Eigen::Vector3d& point, int axis) const {
  const Rect& r = room_.rect;
  const double edges[4] = {point.x() - r.x0, r.x1 - point.x(), point.y() - r.y0, r.y1 - point.y()};
  double light = 0.0;
  if (lamps_on_) {
    // Compressed, so that nothing but a lamp itself is too bright: 1 at the mean, 1.6 at most.
    const double near = gain_ > 0.0 ? gain_ * lamps_at(point) : 1.0;
    light = kBase + kMeanFromLamps * 1.6 * near / (0.6 + near);
  } else {
    light = 0.55 + 0.75 * std::exp(-std::max(0.0, edges[window_side_]) / 4.0);
  }
  double occlusion = 1.0;
  for (int i = 0; i < 4; ++i) {
    if (axis != i / 2) occlusion -= 0.16 * std::exp(-std::max(0.0, edges[i]) / kOcclusion_m);
  }
  if (axis != 2) occlusion -= 0.16 * std::exp((point.z() - room_.ceiling_m) / kOcclusion_m);
  return light * std::max(0.4, occlusion);
}

}  // namespace zenith::sim
