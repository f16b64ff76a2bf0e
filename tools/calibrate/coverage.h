#pragma once
// Which parts of the image have seen corners: cells of three rings round the optical axis and eight
// sectors. What the rectified image uses reaches to about 65 degrees from the axis.

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slam/image/lens.h"

namespace zenith::tools {

inline constexpr int kRings = 3;
inline constexpr int kSectors = 8;
inline constexpr double kRingEdges_deg[kRings + 1] = {0.0, 22.0, 44.0, 65.0};

struct CoverageCell {
  bool visible = false;  // the image shows its middle
  int corners = 0;

  // A handful from one view tells little.
  bool enough() const { return corners >= 6; }
};

struct Coverage {
  std::array<std::array<CoverageCell, kSectors>, kRings> cells = {};
  double farthest_deg = 0.0;  // corner from the optical axis
  int visible = 0;            // cells
  int covered = 0;            // of these
};

Coverage coverage_of(const Lens& lens, const std::vector<Eigen::Vector2d>& corners_px);

// "at the upper left rim"; sector 0 is to the right, 2 below.
std::string cell_name(int ring, int sector);
// Names of visible cells with too few corners.
std::vector<std::string> missing_cells(const Coverage& coverage);

}  // namespace zenith::tools
