#pragma once
// OpenCV's ChArUco boards, whose interface differs between OpenCV 4.6 and 4.7.

#include <vector>

#include <opencv2/core.hpp>

#include "tools/calibrate/target.h"

namespace zenith::tools {

// In the dictionary, 4 x 4 bits.
inline constexpr int kCharucoMarkers = 50;

cv::Mat charuco_raster(const Target& target);

// The inner corners next to markers that were found: numbers and places in pixels.
void detect_charuco(const cv::Mat& grey, const Target& target, std::vector<int>& ids,
                    std::vector<cv::Point2f>& corners);

}  // namespace zenith::tools
