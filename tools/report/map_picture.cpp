#include "tools/report/map_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>

#include "tools/report/canvas.h"
#include "tools/report/map_layout.h"
#include "tools/report/map_view.h"
#include "tools/report/table.h"

namespace zenith::tools {
namespace {

constexpr double kSigmas = 2.0;
constexpr Colour kTruth{120, 126, 132};

constexpr double kVague_m = 0.15;  // ellipses longer than this to each side are drawn pale

bool vague(const MapLandmark& mark) {
  const Eigen::Vector2d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(mark.covariance_m2).eigenvalues();
  return kSigmas * std::sqrt(std::max(variances.y(), 0.0)) > kVague_m;
}

// Towards the white of the page.
Colour pale(const Colour& colour) {
  const auto mix = [](int value) { return 255 - (255 - value) * 2 / 5; };
  return {mix(colour.red), mix(colour.green), mix(colour.blue)};
}

void draw_landmarks_of(Canvas& canvas, const MapView& view, const MapLayout& layout,
                       bool vague_ones, bool common) {
  for (const MapLandmark& mark : layout.landmarks) {
    if (mark.common != common || vague(mark) != vague_ones) continue;
    const Colour full = common ? kMagenta : robot_colour(static_cast<std::size_t>(mark.robot));
    const Colour colour = vague_ones ? pale(full) : full;
    const Eigen::Vector2d at = view(mark.position_m);
    canvas.ellipse(at, view.covariance(mark.covariance_m2), kSigmas, colour, 1.0);
    canvas.disc(at, common ? 2.6 : 1.8, colour);
  }
}

// Vague ones first and common ones last, so that what is known well stays visible.
void draw_landmarks(Canvas& canvas, const MapView& view, const MapLayout& layout) {
  for (const bool vague_ones : {true, false}) {
    for (const bool common : {false, true}) {
      draw_landmarks_of(canvas, view, layout, vague_ones, common);
    }
  }
}

void draw_robots(Canvas& canvas, const MapView& view, const MapLayout& layout) {
  for (std::size_t i = 0; i < layout.robots.size(); ++i) {
    const PlacedRobot& robot = layout.robots[i];
    const Colour colour = robot_colour(i);
    canvas.path(view(robot.path), colour, 2.6);
    canvas.path(view(robot.truth), kTruth, 1.0);
    if (robot.path.empty()) continue;
    canvas.disc(view(robot.path.front()), 7.0, {255, 255, 255});
    canvas.ring(view(robot.path.front()), 7.0, colour, 2.5);
    canvas.disc(view(robot.path.back()), 7.0, colour);
  }
}

void draw_names(Canvas& canvas, const MapView& view, const MapLayout& layout) {
  for (std::size_t i = 0; i < layout.robots.size(); ++i) {
    const PlacedRobot& robot = layout.robots[i];
    if (robot.path.empty()) continue;
    const Eigen::Vector2d at = view(robot.path.front()) + Eigen::Vector2d(12.0, -10.0);
    const double width = canvas.text_width(robot.name, 13.0, true);
    const Eigen::Vector2d left(std::min(at.x(), kMapWidth_px - width - 8.0), at.y());
    canvas.halo(left, robot.name, 13.0, Anchor::kLeft, true);
    canvas.text(left, robot.name, 13.0, robot_colour(i), Anchor::kLeft, true);
  }
}

std::string title(const MapLayout& layout) {
  const std::size_t count = layout.robots.size();
  const auto placed = static_cast<std::size_t>(
      std::count_if(layout.robots.begin(), layout.robots.end(),
                    [](const PlacedRobot& robot) { return robot.placed; }));
  if (count == 1) return "The map of " + layout.robots[0].name;
  if (placed == count) return "One map of " + std::to_string(count) + " robots";
  if (placed == 1) return std::to_string(count) + " robots, not merged";
  return "One map of " + std::to_string(placed) + " robots, " + std::to_string(count - placed) +
         " not merged";
}

std::string merge_line(const TeamFigures& figures) {
  std::string text;
  for (const PairFigures& pair : figures.pairs) {
    if (pair.own > pair.peer || !pair.merge_time_s) continue;
    text += (text.empty() ? "" : "     ") +
            figures.robots[static_cast<std::size_t>(pair.own)].name + " + " +
            figures.robots[static_cast<std::size_t>(pair.peer)].name + " merged after " +
            fixed(pair.merge_time_s, 1) + " s";
    if (!pair.merged_at_end) text += " (withdrawn)";
    if (!pair.at_end) continue;
    text += ", transform off by " + fixed(100.0 * pair.at_end->position_m, 1) + " cm, " +
            fixed(pair.at_end->angle_rad * 180.0 / std::numbers::pi, 2) + " deg";
  }
  return text;
}

void draw_scale(Canvas& canvas, const MapView& view, double y) {
  const double wanted = 220.0 / view.scale();
  double length = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double factor : {5.0, 2.0}) {
    if (length * factor <= wanted) {
      length *= factor;
      break;
    }
  }
  const Eigen::Vector2d right(kMapWidth_px - kMapMargin_px, y);
  const Eigen::Vector2d left = right - Eigen::Vector2d(length * view.scale(), 0.0);
  canvas.line(left, right, kInk, 2.0);
  for (const Eigen::Vector2d& end : {left, right}) {
    canvas.line(end - Eigen::Vector2d(0.0, 6.0), end + Eigen::Vector2d(0.0, 6.0), kInk, 2.0);
  }
  canvas.text(0.5 * (left + right) - Eigen::Vector2d(0.0, 12.0),
              fixed(length, length < 1.0 ? 1 : 0) + " m", 13.0, kInk, Anchor::kCentre);
}

std::string robot_line(const RobotFigures& robot) {
  std::string text = robot.name + ": " + fixed(robot.path_m, 1) + " m driven, " +
                     std::to_string(robot.landmarks) + " landmarks";
  if (!robot.ate_m) return text;
  return text + ", error " + fixed(100.0 * *robot.ate_m, 1) + " cm (wheels alone " +
         fixed(100.0 * *robot.odometry_ate_m, 1) + " cm)";
}

void draw_legend(Canvas& canvas, const MapView& view, const MapLayout& layout,
                 const TeamFigures& figures) {
  double y = view.map_end_px() + 34.0;
  for (std::size_t i = 0; i < figures.robots.size(); ++i, y += 28.0) {
    canvas.line({kMapMargin_px, y - 5.0}, {kMapMargin_px + 44.0, y - 5.0}, robot_colour(i), 3.0);
    canvas.ring({kMapMargin_px, y - 5.0}, 5.0, robot_colour(i), 2.0);
    canvas.disc({kMapMargin_px + 44.0, y - 5.0}, 5.0, robot_colour(i));
    canvas.text({kMapMargin_px + 62.0, y}, robot_line(figures.robots[i]), 13.0, kInk);
  }
  double x = kMapMargin_px;
  const auto entry = [&](const std::string& text) {
    canvas.text({x + 56.0, y}, text, 13.0, kInk);
    x += 56.0 + canvas.text_width(text, 13.0) + 40.0;
  };
  Eigen::Matrix2d shape;
  shape << 90.0, 20.0, 20.0, 25.0;
  for (const bool common : {false, true}) {
    const Colour colour = common ? kMagenta : robot_colour(0);
    canvas.ellipse({x + 22.0, y - 5.0}, shape, 1.0, colour, 1.0);
    canvas.disc({x + 22.0, y - 5.0}, common ? 2.6 : 1.8, colour);
    entry(common ? "landmark held by several robots" : "landmark, 2 sigma");
  }
  const bool truth = std::any_of(layout.robots.begin(), layout.robots.end(),
                                 [](const PlacedRobot& robot) { return !robot.truth.empty(); });
  if (truth) {
    canvas.line({x, y - 5.0}, {x + 44.0, y - 5.0}, kTruth, 1.2);
    entry("ground truth");
  }
  draw_scale(canvas, view, view.map_end_px() + 40.0);
}

}  // namespace

Status draw_map(const std::filesystem::path& path, const TeamLog& log, const TeamFigures& figures) {
  const MapLayout layout = lay_out_map(log);
  const int legend_px = 34 + 28 * static_cast<int>(log.robots.size()) + 40;
  const MapView view(layout, legend_px);
  Canvas canvas(kMapWidth_px, view.height_px());
  canvas.text({kMapMargin_px, 58.0}, title(layout), 24.0, kInk, Anchor::kLeft, true);
  canvas.text({kMapMargin_px, 92.0}, merge_line(figures), 13.0, kGrey);
  draw_landmarks(canvas, view, layout);
  draw_robots(canvas, view, layout);
  draw_names(canvas, view, layout);
  draw_legend(canvas, view, layout, figures);
  return canvas.save(path);
}

}  // namespace zenith::tools
