#pragma once
// Rate, exposure and gain as libcamera's controls.

#include <string>
#include <vector>

#include <libcamera/camera.h>
#include <libcamera/controls.h>

#include "drivers/camera/v4l2_settings.h"

namespace zenith {

struct LibcameraControls {
  libcamera::ControlList list;  // for Camera::start()
  double rate_hz = 0.0;         // 0: not in our hands
  std::vector<std::string> warnings;
};

// What cannot be set, or not as asked, comes back as a sentence.
LibcameraControls choose_libcamera_controls(const libcamera::Camera& camera,
                                            const V4l2Settings& settings);

}  // namespace zenith
