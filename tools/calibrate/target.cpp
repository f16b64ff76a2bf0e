#include "tools/calibrate/target.h"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "tools/calibrate/charuco.h"

namespace zenith::tools {
namespace {

bool read_whole(std::string_view text, int& value) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() && read.ptr == text.data() + text.size();
}

cv::Mat checkerboard_raster(const Target& target) {
  constexpr int kCells = Target::kCellsPerSquare;
  cv::Mat raster(target.rows * kCells, target.columns * kCells, CV_8UC1, cv::Scalar(255));
  for (int row = 0; row < target.rows; ++row) {
    for (int column = row % 2; column < target.columns; column += 2) {
      raster(cv::Rect(column * kCells, row * kCells, kCells, kCells)).setTo(0);
    }
  }
  return raster;
}

}  // namespace

Result<Target> parse_target(const std::string& kind, const std::string& squares, double square_mm) {
  Target target;
  if (kind == "charuco") {
    target.kind = TargetKind::kCharuco;
  } else if (kind != "checkerboard") {
    return Error{"expected a target checkerboard or charuco, found '" + kind + "'"};
  }
  const std::size_t cross = squares.find('x');
  if (cross == std::string::npos ||
      !read_whole(std::string_view(squares).substr(0, cross), target.columns) ||
      !read_whole(std::string_view(squares).substr(cross + 1), target.rows)) {
    return Error{"expected squares as COLUMNSxROWS, such as 9x6, found '" + squares + "'"};
  }
  if (target.columns < 4 || target.rows < 4 || target.columns > 30 || target.rows > 30) {
    return Error{"expected 4 to 30 squares a side, found " + squares};
  }
  if (!(square_mm >= 2.0 && square_mm <= 1000.0)) {
    return Error{"expected squares of 2 to 1000 mm, found " + std::to_string(square_mm)};
  }
  target.square_m = 1e-3 * square_mm;
  const int markers = target.columns * target.rows / 2;
  if (target.kind == TargetKind::kCharuco && markers > kCharucoMarkers) {
    return Error{"a charuco board has at most " + std::to_string(kCharucoMarkers) +
                 " markers, this one would need " + std::to_string(markers) +
                 ": take fewer squares"};
  }
  return target;
}

std::string target_text(const Target& target) {
  char text[96];
  std::snprintf(text, sizeof text, "%s of %d x %d squares of %.4g mm",
                target.kind == TargetKind::kCharuco ? "ChArUco board" : "checkerboard",
                target.columns, target.rows, 1e3 * target.square_m);
  return text;
}

cv::Mat target_raster(const Target& target) {
  return target.kind == TargetKind::kCharuco ? charuco_raster(target) : checkerboard_raster(target);
}

}  // namespace zenith::tools
