#pragma once
// Asks a device for all that it offers.

#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_offer.h"
#include "platform/base/result.h"

namespace zenith {

// Identity and formats with sizes and rates. Rates of a range of sizes are asked at width x height,
// or at the largest size when that lies outside. A device that does not capture has no formats.
Result<V4l2Offer> enumerate_v4l2(const V4l2Device& device, const std::string& path, int width,
                                 int height);

}  // namespace zenith
