#pragma once
// Where a calibration goes: into a robot's configuration (zenith.toml, all else in it stays), or
// into a recording, whose lens and mount stand in sensor.yaml.

#include <filesystem>
#include <string>

#include "platform/base/result.h"
#include "slam/robot.h"

namespace zenith::tools {

// Whether `path` is the folder of a recording.
bool is_recording(const std::filesystem::path& path);

// A new lens, which check_lens() has to pass. The mount and the rate of a recording stay.
Status write_lens(const std::filesystem::path& path, const Lens& lens);

// Mount and wheels, and by how much the base's frames are late.
Status write_robot(const std::filesystem::path& path, const RobotConfig& robot, double latency_s);

// sensor.yaml with this lens; of an older file the mount and the rate stay.
Status write_sensor_file(const std::filesystem::path& path, const Lens& lens);

// A number with the digits that are worth keeping, as TOML writes it.
std::string toml_number(double value, int digits);

}  // namespace zenith::tools
