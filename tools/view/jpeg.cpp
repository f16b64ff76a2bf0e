#include "tools/view/jpeg.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace zenith::tools {

std::vector<unsigned char> write_jpeg(int width, int height,
                                      const std::vector<unsigned char>& grey) {
  constexpr int kQuality = 75;
  const cv::Mat image(height, width, CV_8UC1, const_cast<unsigned char*>(grey.data()));
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return jpeg;
}

}  // namespace zenith::tools
