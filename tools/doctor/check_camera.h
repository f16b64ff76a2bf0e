#pragma once
// Checks of the camera: there, permitted, capturing, offering what is asked for, free, delivering,
// and showing something. Facts are gathered apart from their verdicts, so that tests feed both.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/v4l2_io.h"
#include "drivers/camera/v4l2_settings.h"
#include "slam/image/image.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/machine_files.h"

namespace zenith::tools {

// Node, permission, capture, format with size and rate, controls. `path` becomes that of the
// device when it can stream as asked, else it stays empty.
Findings check_camera_device(const V4l2Settings& settings, V4l2Io& io, std::string& path);

// Who has it. `daemon_pid` (0: none) is no fault.
Finding check_camera_free(const std::vector<DeviceUser>& users, int daemon_pid);

struct StreamFacts {
  std::string problem;  // it could not be opened, or was lost
  std::vector<Time> stamps;
  Time last_received;
  CameraCounters counters;
};

struct PictureFacts {
  double mean = 0.0;       // 0 .. 255
  double deviation = 0.0;  // standard deviation of all pixels
  double detail = 0.0;     // mean difference of neighbours in a row, less what noise explains
  double bright = 0.0;     // share of pixels at 250 and above
};
PictureFacts measure_picture(ImageView image);

// Opens the camera, takes frames for `how_long`, and measures the last.
StreamFacts watch_camera(Camera& camera, Duration how_long, std::optional<PictureFacts>& picture);

Finding check_camera_rate(const StreamFacts& facts, double wanted_hz);
Finding check_camera_stamps(const StreamFacts& facts);
Finding check_picture(const PictureFacts& picture);

}  // namespace zenith::tools
