#pragma once
// Where a calibration goes: into a robot's configuration (zenith.toml, all else in it stays), or
// into a recording, whose lens and mount stand in sensor.yaml.

#include <filesystem>
#include <optional>
#include <string>

#include "platform/base/result.h"
#include "slam/robot.h"
#include "tools/calibrate/edit_toml.h"
#include "tools/calibrate/wheel_curve.h"

namespace zenith::tools {

// Whether `path` is the folder of a recording.
bool is_recording(const std::filesystem::path& path);

// A new lens, which check_lens() has to pass. The mount and the rate of a recording stay.
Status write_lens(const std::filesystem::path& path, const Lens& lens);

// A calibrated robot but for its lens.
struct RobotResult {
  RobotConfig robot;
  double latency_s = 0.0;  // by which the base's frames are late
  // Where it is not as it was: how the base's wheels are to be read.
  std::optional<WheelOrder> wheels;
};

// The same as values of a zenith.toml; edited_toml() of an empty text makes them lines to paste.
TomlValues robot_values(const RobotResult& result);

// Into a recording whose wheels are poses (odometry.tum): the track width so far becomes
// odometry.poses_track_width_m, if that is not set, so that the poses tell the same travel as
// before.
Status write_robot(const std::filesystem::path& path, const RobotResult& result);

// sensor.yaml with this lens; of an older file the mount and the rate stay.
Status write_sensor_file(const std::filesystem::path& path, const Lens& lens);

// A number with the digits that are worth keeping, as TOML writes it.
std::string toml_number(double value, int digits);

}  // namespace zenith::tools
