#pragma once
// Pictures for the page: one robot's grey image as JPEG.

#include <vector>

namespace zenith::tools {

// A RobotState's WriteJpeg.
std::vector<unsigned char> write_jpeg(int width, int height,
                                      const std::vector<unsigned char>& grey);

}  // namespace zenith::tools
