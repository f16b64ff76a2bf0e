#pragma once
// All video devices of the machine with what they offer, for `zenith doctor` and for messages.
// Opens each for a moment, which disturbs no running stream; never on a thread with deadlines.

#include <string>
#include <vector>

#include "drivers/camera/v4l2_controls.h"
#include "drivers/camera/v4l2_io.h"
#include "drivers/camera/v4l2_offer.h"

namespace zenith {

struct V4l2ProbedDevice {
  std::string path;
  std::string problem;  // why it could not be asked; empty when it could
  V4l2Offer offer;
  std::vector<V4l2Control> controls;
  bool readable = false;  // captures in a format that the camera driver can read
};

// In the order of their numbers, also those that do not capture. Rates of size ranges are given at
// width x height.
std::vector<V4l2ProbedDevice> probe_v4l2(int width, int height, V4l2Io& io = kernel_v4l2_io());

}  // namespace zenith
