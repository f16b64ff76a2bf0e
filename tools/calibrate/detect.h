#pragma once
// The corners of a target in an image.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "tools/calibrate/target.h"

namespace zenith::tools {

struct Detection {
  std::vector<int> ids;                     // of the target's inner corners
  std::vector<Eigen::Vector2d> corners_px;  // the first pixel's centre is (0, 0)
};

// Fewer corners fix no pose.
inline constexpr std::size_t kLeastCorners = 8;

// `grey` is 8-bit. A checkerboard must be seen whole; of a ChArUco board a part is enough. Without
// a usable board the error says what was found instead.
Result<Detection> detect_target(const cv::Mat& grey, const Target& target);

}  // namespace zenith::tools
