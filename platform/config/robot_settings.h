#pragma once
// The settings that describe a robot and its algorithm, the same in every file that holds them: a
// recording's robot.toml and the daemon's configuration.

#include <string>

#include "drivers/odometry/wheel_codec_config.h"
#include "platform/config/setting.h"
#include "slam/parameters.h"
#include "slam/robot.h"

namespace zenith {

// "wheels.track_width_m", ...
Settings wheel_settings(Wheels& wheels);

// "odometry.codec", and for each of wheel_codec_fields() "odometry." and its key.
Settings odometry_settings(WheelCodecConfig& config);
Setting odometry_setting(const WheelCodecField& field, WheelCodecConfig& config);

// Whether `name` can be that of a CAN interface.
bool is_interface_name(const std::string& name);

// "112 degrees from side to side, fitted to the lens; 100 % of it lie in the lens's image".
std::string view_text(const Parameters& parameters, const RobotConfig& robot);

// "slam." and the key, for each of parameter_table().
Settings slam_settings(Parameters& parameters);

}  // namespace zenith
