#pragma once
// The recorded fisheye frames of an office ceiling, with their lens and mount from camera.json.

#include <filesystem>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "platform/base/result.h"
#include "slam/robot.h"

namespace zenith {

struct CeilingSequence {
  RobotConfig robot;
  double ceiling_height_m = 0.0;  // above the camera
  double tilt_deg = 0.0;
  std::vector<cv::Mat> frames;
};

Result<CeilingSequence> load_ceiling_sequence(const std::filesystem::path& folder);

}  // namespace zenith
