#include "platform/recording/robot_file.h"

#include <cstdio>
#include <cstring>
#include <utility>

#include "platform/config/robot_settings.h"
#include "platform/config/toml_text.h"
#include "platform/recording/layout.h"
#include "platform/recording/odometry_section.h"

namespace zenith {
namespace {

Settings settings_of(RobotFile& robot, OdometryKeys keys) {
  Settings settings = wheel_settings(robot.wheels);
  for (Setting& setting : settings) setting.required = true;
  const Settings odometry = odometry_settings(robot.odometry);
  settings.insert(settings.end(), odometry.begin(), odometry.end());
  Setting interface;
  interface.key = "odometry.can_interface";
  interface.at = &robot.can_interface;
  settings.push_back(std::move(interface));
  settings.push_back({"odometry.poses_track_width_m", "m", 0.0, 5.0,
                      "odometry.tum: the track width that its poses were made with",
                      &robot.poses_track_width_m});
  settings.push_back({"odometry.log_start_s", "s", -1.0, 4e9,
                      "when the first line of the CAN log came, on the frames' clock",
                      &robot.log_start_s});
  if (keys == OdometryKeys::kNone) return settings;
  for (Setting& setting : settings) {
    if (setting.key == "odometry.codec" || setting.key == "odometry.can_interface") {
      setting.required = true;
    }
  }
  return settings;
}

}  // namespace

std::optional<Time> RobotFile::log_start() const {
  if (log_start_s < 0.0) return std::nullopt;
  return Time{0} + Duration::from_seconds(log_start_s);
}

Result<RobotFile> read_robot_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return Error{path.string() + ": missing: a recording holds its robot's configuration there"};
  }
  const auto text = read_toml(path);
  if (!text) return text.error();
  const auto folder = path.parent_path();
  const bool without_can = std::filesystem::exists(layout::odometry_csv(folder), code) ||
                           std::filesystem::exists(layout::odometry_tum(folder), code);
  return parse_robot_file(*text, path, without_can ? OdometryKeys::kNone : OdometryKeys::kCan);
}

Result<RobotFile> parse_robot_file(std::string_view text, const std::filesystem::path& path,
                                   OdometryKeys keys) {
  Problems problems(path);
  RobotFile robot;
  const KeyLines lines = parse_settings(text, settings_of(robot, keys), problems);
  if (!is_interface_name(robot.can_interface)) {
    problems.add(lines.of("odometry.can_interface"),
                 "odometry.can_interface '" + robot.can_interface + "' is no interface's name");
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
  if (robot.poses_track_width_m != 0.0) {
    std::snprintf(text + std::strlen(text), sizeof text - std::strlen(text),
                  "poses_track_width_m = %.9f   # of the poses in odometry.tum\n",
                  robot.poses_track_width_m);
  }
  if (robot.log_start_s >= 0.0) {
    std::snprintf(text + std::strlen(text), sizeof text - std::strlen(text),
                  "log_start_s = %.9f   # when the first line of the CAN log came\n",
                  robot.log_start_s);
  }
  return text + format_odometry(robot.odometry);
}

}  // namespace zenith
