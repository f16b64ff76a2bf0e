#include "tools/recording/robot_file.h"

#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "tools/overrides.h"
#include "tools/recording/problems.h"

namespace zenith::tools {
namespace {

int line_of(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

void check_keys(const toml::table& table, const std::string& prefix,
                const std::vector<std::string>& known, Problems& problems) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = nearest_words(name, known);
    problems.add(line_of(node),
                 "unknown key " + prefix + name +
                     (near.empty() ? "" : "; did you mean " + prefix + near[0] + "?"));
  }
}

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

void read_text(const toml::table& file, const char* section, const char* key, std::string& value,
               Problems& problems) {
  const std::string name = std::string(section) + "." + key;
  const auto node = file[section][key];
  if (!node) return problems.add(0, "missing key " + name);
  const auto text = node.value<std::string>();
  if (!text) return problems.add(line_of(*node.node()), name + " is no text");
  value = *text;
}

void check_section(const toml::table& file, const char* section,
                   const std::vector<std::string>& known, Problems& problems) {
  const auto node = file[section];
  if (!node) return;  // its keys are told as missing
  if (const toml::table* table = node.as_table()) {
    check_keys(*table, std::string(section) + ".", known, problems);
  } else {
    problems.add(line_of(*node.node()), std::string(section) + " is no section");
  }
}

void read_sections(const toml::table& file, RobotFile& robot, Problems& problems) {
  check_keys(file, "", {"wheels", "odometry"}, problems);
  check_section(file, "wheels", {"track_width_m", "left_scale", "right_scale"}, problems);
  check_section(file, "odometry", {"codec", "can_interface"}, problems);
  Wheels& wheels = robot.wheels;
  read_number(file, "wheels", "track_width_m", 0.02, 5.0, wheels.track_width_m, problems);
  read_number(file, "wheels", "left_scale", 0.1, 10.0, wheels.left_scale, problems);
  read_number(file, "wheels", "right_scale", 0.1, 10.0, wheels.right_scale, problems);
  read_text(file, "odometry", "codec", robot.codec, problems);
  read_text(file, "odometry", "can_interface", robot.can_interface, problems);
  if (robot.codec != "agilex_v2") {
    problems.add(0, "odometry.codec '" + robot.codec + "' is unknown; known: agilex_v2");
  }
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
      wheels.track_width_m, wheels.left_scale, wheels.right_scale, robot.codec.c_str(),
      robot.can_interface.c_str());
  return text;
}

}  // namespace zenith::tools
