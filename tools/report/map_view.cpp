#include "tools/report/map_view.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace zenith::tools {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// What the picture must show.
Points points_of(const MapLayout& layout) {
  Points points;
  for (const PlacedRobot& robot : layout.robots) {
    points.insert(points.end(), robot.path.begin(), robot.path.end());
  }
  for (const MapLandmark& mark : layout.landmarks) {
    if (layout.holds(mark.position_m)) points.push_back(mark.position_m);
  }
  return points;
}

// Middle and size of the turned points' box.
std::pair<Eigen::Vector2d, Eigen::Vector2d> extent_of(const Points& points,
                                                      const Eigen::Matrix2d& R) {
  if (points.empty()) return {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  Eigen::Vector2d min = R * points.front();
  Eigen::Vector2d max = min;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d turned = R * point;
    min = min.cwiseMin(turned);
    max = max.cwiseMax(turned);
  }
  return {0.5 * (min + max), max - min};
}

// Turns the map so that robots drive along the page or across it, as they do along walls, and that
// its longer side lies flat. Segments of the paths vote for their direction modulo a right angle.
double flat_angle(const MapLayout& layout, const Points& points) {
  std::complex<double> votes = 0.0;
  for (const PlacedRobot& robot : layout.robots) {
    for (std::size_t i = 1; i < robot.path.size(); ++i) {
      const Eigen::Vector2d step = robot.path[i] - robot.path[i - 1];
      votes += std::polar(step.norm(), 4.0 * std::atan2(step.y(), step.x()));
    }
  }
  const double angle = -0.25 * std::arg(votes);
  const Eigen::Vector2d extent = extent_of(points, rotation(angle)).second;
  return extent.x() < extent.y() ? angle + 0.5 * std::numbers::pi : angle;
}

}  // namespace

MapView::MapView(const MapLayout& layout, int legend_px) {
  const Points points = points_of(layout);
  turn_ = rotation(flat_angle(layout, points));
  constexpr double kFree_m = 0.7;
  constexpr int kMin_px = 420;
  constexpr int kMax_px = 1200;
  const auto [middle, extent] = extent_of(points, turn_);
  const Eigen::Vector2d seen = extent + Eigen::Vector2d::Constant(2.0 * kFree_m);
  const double inner = kMapWidth_px - 2.0 * kMapMargin_px;
  scale_ = std::min(inner / seen.x(), kMax_px / seen.y());
  map_px_ = std::max(kMin_px, static_cast<int>(std::ceil(scale_ * seen.y())));
  height_px_ = kMapHeader_px + map_px_ + legend_px;
  middle_m_ = turn_.transpose() * middle;
  middle_px_ = {0.5 * kMapWidth_px, kMapHeader_px + 0.5 * map_px_};
}

}  // namespace zenith::tools
