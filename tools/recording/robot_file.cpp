#include "tools/recording/robot_file.h"

#include <cstdio>
#include <optional>

#include <toml++/toml.h>

#include "tools/recording/odometry_section.h"
#include "tools/recording/problems.h"
#include "tools/recording/toml_keys.h"

namespace zenith::tools {
namespace {

void read_number(const toml::table& file, const char* section, const char* key, double min,
                 double max, double& value, Problems& problems) {
  const std::string name = std::string(section) + "." + key;
  const auto node = file[section][key];
  if (!node) return problems.add(0, "missing key " + name);
  const std::optional<double> number = node.value<double>();
  if (!number) return problems.add(line_of(*node.node()), name + " is no number");
  problems.check_range(line_of(*node.node()), name, *number, min, max);
  value = *number;
}

void read_sections(const toml::table& file, RobotFile& robot, Problems& problems) {
  check_keys(file, "", {"wheels", "odometry"}, problems);
  check_section(file, "wheels", {"track_width_m", "left_scale", "right_scale"}, problems);
  Wheels& wheels = robot.wheels;
  read_number(file, "wheels", "track_width_m", 0.02, 5.0, wheels.track_width_m, problems);
  read_number(file, "wheels", "left_scale", 0.1, 10.0, wheels.left_scale, problems);
  read_number(file, "wheels", "right_scale", 0.1, 10.0, wheels.right_scale, problems);
  read_text(file, "odometry", "can_interface", robot.can_interface, problems);
  read_odometry(file, robot.odometry, problems);
  if (robot.can_interface.empty() ||
      robot.can_interface.find_first_of("/ \t") != std::string::npos) {
    problems.add(0, "odometry.can_interface '" + robot.can_interface + "' is no interface's name");
  }
}

}  // namespace

Result<RobotFile> read_robot_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return Error{path.string() + ": missing: a recording holds its robot's configuration there"};
  }
  Problems problems(path);
  RobotFile robot;
  try {
    read_sections(toml::parse_file(path.string()), robot, problems);
  } catch (const toml::parse_error& error) {
    problems.add(static_cast<int>(error.source().begin.line), std::string(error.description()));
  }
  if (problems.any()) return problems.error();
  std::string& dbc = robot.odometry.dbc.file;
  if (!dbc.empty()) dbc = (path.parent_path() / dbc).string();
  return robot;
}

std::string format_robot_file(const RobotFile& robot) {
  const Wheels& wheels = robot.wheels;
  char text[1024];
  std::snprintf(
      text, sizeof text,
      "# The robot of this recording. Its camera, with the mount (T_BS), is described in\n"
      "# mav0/cam0/sensor.yaml and nowhere else.\n"
      "\n"
      "[wheels]\n"
      "track_width_m = %.9f   # distance of the wheels' tracks\n"
      "left_scale = %.9f      # true travel by the travel that the base reports\n"
      "right_scale = %.9f\n"
      "\n"
      "[odometry]\n"
      "codec = \"%s\"           # how the base speaks on the CAN bus\n"
      "can_interface = \"%s\"        # recorded in <can_interface>.log\n",
      wheels.track_width_m, wheels.left_scale, wheels.right_scale,
      std::string(wheel_codec_name(robot.odometry.kind)).c_str(), robot.can_interface.c_str());
  return text + format_odometry(robot.odometry);
}

}  // namespace zenith::tools
