#pragma once
// cv::remap's fixed-point maps for the drive's lens: the faster kind.

#include <opencv2/imgproc.hpp>

#include "slam/image/lens_projection.h"
#include "slam/image/rectify.h"
#include "slam/robot.h"

namespace zenith::bench {

struct OpenCvMaps {
  cv::Mat places;
  cv::Mat weights;

  explicit OpenCvMaps(const RobotConfig& robot) {
    const Pinhole pinhole = Pinhole::from_fov(2.0944);
    const Eigen::Matrix3d R = mount_rotation(robot.mount).transpose();
    const LensProjection projection(robot.lens);
    cv::Mat map_u(kRectifiedSize, kRectifiedSize, CV_32F);
    cv::Mat map_v(kRectifiedSize, kRectifiedSize, CV_32F);
    for (int v = 0; v < kRectifiedSize; ++v) {
      for (int u = 0; u < kRectifiedSize; ++u) {
        const Eigen::Vector2d m = pinhole.normalise(u, v);
        const Eigen::Vector2d at =
            projection.project(R * Eigen::Vector3d(m.x(), m.y(), 1.0)).value();
        map_u.at<float>(v, u) = static_cast<float>(at.x());
        map_v.at<float>(v, u) = static_cast<float>(at.y());
      }
    }
    cv::convertMaps(map_u, map_v, places, weights, CV_16SC2);
  }
};

// A view of a frame; it stays where it is.
inline cv::Mat as_mat(const ImageView& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                 static_cast<std::size_t>(image.stride));
}

}  // namespace zenith::bench
