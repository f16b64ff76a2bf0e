#pragma once
// Wheel samples as CAN frames, for a daemon that replays a recording without a CAN log: both wheels
// in one transmit PDO, 32 bits each, in micrometres. They wrap after 2147 m, as counters do.

#include <vector>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec_config.h"
#include "slam/wheels.h"

namespace zenith {

// The codec that reads the frames. Its limits are those of `limits`.
WheelCodecConfig codec_of_samples(const WheelLimits& limits);

CanFrame frame_of_sample(const WheelSample& sample);

}  // namespace zenith
