#pragma once
// robot.toml of a recording: what is known about the robot but for its camera, which sensor.yaml
// describes, mount included. Unknown keys are errors.

#include <filesystem>
#include <string>

#include "platform/base/result.h"
#include "slam/robot.h"

namespace zenith::tools {

struct RobotFile {
  Wheels wheels;
  std::string codec = "agilex_v2";
  std::string can_interface = "can0";  // the log is named after it: can0.log
};

Result<RobotFile> read_robot_file(const std::filesystem::path& path);

// The annotated text of the file.
std::string format_robot_file(const RobotFile& robot);

}  // namespace zenith::tools
