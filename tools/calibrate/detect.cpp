#include "tools/calibrate/detect.h"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/calibrate/charuco.h"

namespace zenith::tools {
namespace {

// Of the distance to the next corner: into the squares beside, but not into their markers.
double window_share(const Target& target) {
  return target.kind == TargetKind::kCharuco ? 0.5 * (1.0 - Target::kMarkerShare) : 0.4;
}

// Nothing has this contrast but a lens cap, a black room or a white wall.
Status check_light(const cv::Mat& grey) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  if (deviation[0] > 3.0) return {};
  return Error{mean[0] < 40.0    ? "the image is black"
               : mean[0] > 215.0 ? "the image is white: too much light"
                                 : "the image shows nothing"};
}

// Each corner to the saddle of the grey values around it; the window stays inside its squares.
void refine(const cv::Mat& grey, double share, std::vector<cv::Point2f>& corners) {
  for (cv::Point2f& corner : corners) {
    double nearest = 1e9;
    for (const cv::Point2f& other : corners) {
      const double distance = std::hypot(other.x - corner.x, other.y - corner.y);
      if (distance > 1e-3) nearest = std::min(nearest, distance);
    }
    const int half = std::clamp(static_cast<int>(share * nearest), 2, 8);
    std::vector<cv::Point2f> one = {corner};
    cv::cornerSubPix(grey, one, cv::Size(half, half), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3));
    const double moved = std::hypot(one[0].x - corner.x, one[0].y - corner.y);
    if (moved < share * nearest) corner = one[0];
  }
}

}  // namespace

Result<Detection> detect_target(const cv::Mat& grey, const Target& target) {
  if (const Status light = check_light(grey); !light) return light.error();
  Detection found;
  std::vector<cv::Point2f> corners;
  if (target.kind == TargetKind::kCharuco) {
    detect_charuco(grey, target, found.ids, corners);
    if (found.ids.size() < kLeastCorners) {
      return Error{"found " + std::to_string(found.ids.size()) + " of the board's " +
                   std::to_string(target.corner_count()) + " corners, expected " +
                   std::to_string(kLeastCorners) + " or more: too far, too blurred or covered"};
    }
  } else {
    const cv::Size size(target.corners_across(), target.corners_down());
    const bool whole = cv::findChessboardCornersSB(
        grey, size, corners, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
    if (!whole || corners.size() != static_cast<std::size_t>(target.corner_count())) {
      return Error{"no whole checkerboard of " + std::to_string(target.columns) + " x " +
                   std::to_string(target.rows) +
                   " squares: a part is out of the image or covered, it is too far, or blurred"};
    }
    for (int id = 0; id < target.corner_count(); ++id) found.ids.push_back(id);
  }
  refine(grey, window_share(target), corners);
  for (const cv::Point2f& corner : corners) found.corners_px.emplace_back(corner.x, corner.y);
  return found;
}

}  // namespace zenith::tools
