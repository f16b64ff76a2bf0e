#pragma once
// What is asked of a camera. Made for V4L2; libcamera takes the same, but for the mains frequency.

#include <optional>
#include <string>

#include "platform/base/result.h"

namespace zenith {

enum class V4l2Exposure { kLeave, kAuto, kManual };
enum class V4l2PowerLine { kLeave, kOff, k50Hz, k60Hz, kAuto };

struct V4l2Settings {
  // "/dev/video0", "/dev/v4l/by-id/...", "name:PART of the card's name" or "bus:PART of the bus
  // information". The last three find the camera again when its number has changed. libcamera: a
  // part of the camera's id or model; empty: the only one.
  std::string device = "/dev/video0";
  int width = 640;  // exactly this size: the lens is calibrated for it
  int height = 480;
  double rate_hz = 30.0;  // a wish: the slowest offered rate that is not slower, else the fastest
  std::string format = "auto";  // or a fourcc, such as "GREY"
  int buffers = 4;              // at least 2; the driver may give another number
  bool copy = false;     // frames into ordinary memory: for drivers whose buffers are slow to read
  double stall_s = 2.0;  // no good frame for so long (at least 3 periods): kLost
  double first_frame_s = 5.0;  // the same for the first frame after open()

  V4l2Exposure exposure = V4l2Exposure::kLeave;
  double exposure_us = 5000.0;  // for kManual
  std::optional<int> gain;      // in the driver's own units; switches automatic gain off
  V4l2PowerLine power_line = V4l2PowerLine::kLeave;
};

// Whether all lie in their ranges.
Status check_settings(const V4l2Settings& settings);

}  // namespace zenith
