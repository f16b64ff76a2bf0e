#pragma once
// The section [odometry] of robot.toml and its subsections, such as [odometry.odrive], as text.

#include <string>

#include "drivers/odometry/wheel_codec_config.h"

namespace zenith {

// The keys after `codec` and `can_interface`: all of the codec's own section, and of the others
// those that differ from their defaults.
std::string format_odometry(WheelCodecConfig config);

}  // namespace zenith
