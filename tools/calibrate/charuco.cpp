#include "tools/calibrate/charuco.h"

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>

namespace zenith::tools {
namespace {

cv::Ptr<cv::aruco::Dictionary> dictionary() {
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
  return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
#else
  return cv::makePtr<cv::aruco::Dictionary>(
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
#endif
}

cv::Ptr<cv::aruco::CharucoBoard> board_of(const Target& target) {
  const auto square = static_cast<float>(target.square_m);
  const auto marker = static_cast<float>(target.square_m * Target::kMarkerShare);
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
  return cv::aruco::CharucoBoard::create(target.columns, target.rows, square, marker, dictionary());
#else
  return cv::makePtr<cv::aruco::CharucoBoard>(cv::Size(target.columns, target.rows), square, marker,
                                              *dictionary());
#endif
}

}  // namespace

cv::Mat charuco_raster(const Target& target) {
  constexpr int kCells = Target::kCellsPerSquare;
  const cv::Size size(target.columns * kCells, target.rows * kCells);
  cv::Mat raster;
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
  board_of(target)->draw(size, raster, 0, 1);
#else
  board_of(target)->generateImage(size, raster, 0, 1);
#endif
  return raster;
}

void detect_charuco(const cv::Mat& grey, const Target& target, std::vector<int>& ids,
                    std::vector<cv::Point2f>& corners) {
  ids.clear();
  corners.clear();
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  auto parameters = cv::makePtr<cv::aruco::DetectorParameters>();
  // Fisheye images bend a marker's sides and make it small.
  parameters->adaptiveThreshWinSizeMin = 5;
  parameters->adaptiveThreshWinSizeMax = 29;
  parameters->adaptiveThreshWinSizeStep = 6;
  parameters->minMarkerPerimeterRate = 0.04;
  parameters->polygonalApproxAccuracyRate = 0.06;
  cv::aruco::detectMarkers(grey, dictionary(), markers, marker_ids, parameters);
  if (marker_ids.empty()) return;
  // One marker beside a corner is enough: at the rim the other one is often too small to read.
  constexpr int kMarkersBeside = 1;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, grey, board_of(target), corners, ids,
                                       cv::noArray(), cv::noArray(), kMarkersBeside);
}

}  // namespace zenith::tools
