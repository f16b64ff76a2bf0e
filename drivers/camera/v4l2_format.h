#pragma once
// Sets the negotiated mode at the device and checks what the driver made of it.

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/camera/luma_format.h"
#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_negotiation.h"
#include "platform/base/result.h"

namespace zenith {

struct V4l2Agreed {
  LumaFormat luma;
  int width = 0;
  int height = 0;
  std::size_t stride = 0;        // bytes from row to row
  std::size_t needed_bytes = 0;  // of a whole frame
  double rate_hz = 0.0;          // 0: the driver does not say
  std::vector<std::string> warnings;
};

// `rate_hz` is asked for when the mode does not name an interval.
Result<V4l2Agreed> set_v4l2_mode(const V4l2Device& device, const V4l2Offer& offer,
                                 const V4l2Mode& mode, double rate_hz);

}  // namespace zenith
