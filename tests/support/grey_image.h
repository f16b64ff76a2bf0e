#pragma once
// Image files as the core sees them: 8-bit grey, without padding.

#include <filesystem>

#include <opencv2/imgcodecs.hpp>

#include "slam/image/image.h"

namespace zenith {

// Empty when there is no such file or it is no image.
inline cv::Mat read_grey(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  return cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
}

// Valid as long as the image is.
inline ImageView view_of(const cv::Mat& grey) {
  return {grey.data, grey.cols, grey.rows, static_cast<std::ptrdiff_t>(grey.step)};
}

}  // namespace zenith
