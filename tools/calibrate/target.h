#pragma once
// What is shown to the camera: a checkerboard, or one with markers in its white squares (ChArUco),
// of which a part that is seen is enough.
//
// Board frame: x along columns, y along rows, metres; the origin is the outer corner of the first
// square. A marker is 0.6 of its square wide, far enough from the square's corners not to disturb
// their refinement, and has 6 x 6 cells: a raster of 10 cells a square holds the whole board
// exactly.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "platform/base/result.h"

namespace zenith::tools {

enum class TargetKind { kCheckerboard, kCharuco };

struct Target {
  TargetKind kind = TargetKind::kCheckerboard;
  int columns = 9;  // squares
  int rows = 6;
  double square_m = 0.030;

  static constexpr int kCellsPerSquare = 10;
  static constexpr double kMarkerShare = 0.6;

  int corners_across() const { return columns - 1; }
  int corners_down() const { return rows - 1; }
  int corner_count() const { return corners_across() * corners_down(); }
  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  // Inner corners, row by row.
  Eigen::Vector2d corner_m(int id) const {
    return {(id % corners_across() + 1) * square_m, (id / corners_across() + 1) * square_m};
  }
};

// "checkerboard" or "charuco", "9x6" and the side of a square in millimetres.
Result<Target> parse_target(const std::string& kind, const std::string& squares, double square_mm);

// "checkerboard of 9 x 6 squares of 30 mm".
std::string target_text(const Target& target);

// The board as its cells: 0 black, 255 white; 10 cells a square.
cv::Mat target_raster(const Target& target);

// A page to print at its true size: *.png with its resolution in it, or *.pdf.
Status write_target(const Target& target, const std::filesystem::path& path);

}  // namespace zenith::tools
