#pragma once
// The section [odometry] of robot.toml and its subsections, such as [odometry.odrive]: which codec,
// and its keys as wheel_codec_fields() lists them. `codec` is needed, all others have defaults.

#include <string>

#include <toml++/toml.h>

#include "drivers/odometry/wheel_codec_config.h"
#include "tools/recording/problems.h"

namespace zenith::tools {

// The value of one key, as TOML writes it.
std::string toml_value(const WheelCodecField& field, WheelCodecConfig& config);

// Ranges are make_wheel_decoder()'s business.
void read_odometry(const toml::table& file, WheelCodecConfig& config, Problems& problems);

// The keys after `codec` and `can_interface`: all of the codec's own section, and of the others
// those that differ from their defaults.
std::string format_odometry(WheelCodecConfig config);

}  // namespace zenith::tools
