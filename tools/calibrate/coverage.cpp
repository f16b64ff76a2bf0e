#include "tools/calibrate/coverage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/image/lens_projection.h"

namespace zenith::tools {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

bool shows(const LensProjection& lens, int ring, int sector) {
  const double theta = 0.5 * (kRingEdges_deg[ring] + kRingEdges_deg[ring + 1]) / kDegPerRad;
  const double azimuth = sector * 2.0 * std::numbers::pi / kSectors;
  const auto uv = lens.project(
      {std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)});
  return uv && lens.in_image(*uv);
}

}  // namespace

Coverage coverage_of(const Lens& lens, const std::vector<Eigen::Vector2d>& corners_px) {
  const LensProjection projection(lens);
  Coverage coverage;
  for (const Eigen::Vector2d& corner : corners_px) {
    const auto seen = projection.unproject(corner);
    if (!seen) continue;
    const Eigen::Vector3d& ray = *seen;
    const double theta_deg = std::atan2(ray.head<2>().norm(), ray.z()) * kDegPerRad;
    coverage.farthest_deg = std::max(coverage.farthest_deg, theta_deg);
    const double turn = std::atan2(ray.y(), ray.x()) / (2.0 * std::numbers::pi) * kSectors;
    const auto sector = static_cast<std::size_t>((std::lround(turn) + kSectors) % kSectors);
    for (std::size_t ring = 0; ring < kRings; ++ring) {
      if (theta_deg < kRingEdges_deg[ring + 1]) {
        ++coverage.cells[ring][sector].corners;
        break;
      }
    }
  }
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      CoverageCell& cell =
          coverage.cells[static_cast<std::size_t>(ring)][static_cast<std::size_t>(sector)];
      cell.visible = shows(projection, ring, sector);
      coverage.visible += cell.visible;
      coverage.covered += cell.visible && cell.enough();
    }
  }
  return coverage;
}

std::string cell_name(int ring, int sector) {
  constexpr const char* kSides[kSectors] = {"right", "lower right", "lower", "lower left",
                                            "left",  "upper left",  "upper", "upper right"};
  constexpr const char* kPlaces[kRings] = {"near the middle, towards the ", "half way out, ",
                                           "at the rim, "};
  return std::string(kPlaces[ring]) + kSides[sector];
}

std::vector<std::string> missing_cells(const Coverage& coverage) {
  std::vector<std::string> names;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      const CoverageCell& cell =
          coverage.cells[static_cast<std::size_t>(ring)][static_cast<std::size_t>(sector)];
      if (cell.visible && !cell.enough()) names.push_back(cell_name(ring, sector));
    }
  }
  return names;
}

}  // namespace zenith::tools
