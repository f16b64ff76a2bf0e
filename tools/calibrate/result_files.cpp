#include "tools/calibrate/result_files.h"

#include <cstdio>
#include <numbers>
#include <utility>

#include "platform/config/lens_settings.h"
#include "platform/recording/layout.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/sensor_file.h"
#include "tools/atomic_output.h"
#include "tools/calibrate/edit_toml.h"

namespace zenith::tools {

bool is_recording(const std::filesystem::path& path) {
  std::error_code code;
  return std::filesystem::is_directory(path, code) &&
         std::filesystem::exists(layout::robot(path), code);
}

std::string toml_number(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

Status write_sensor_file(const std::filesystem::path& path, const Lens& lens) {
  if (const Status good = check_lens(lens); !good) return good;
  SensorFile sensor;
  std::error_code code;
  if (std::filesystem::exists(path, code)) {
    const auto old = read_sensor_file(path);
    if (!old) return old.error();
    sensor = *old;
  }
  sensor.lens = lens;
  return write_file(path, format_sensor_file(sensor));
}

Status write_lens(const std::filesystem::path& path, const Lens& lens) {
  if (const Status good = check_lens(lens); !good) return good;
  if (is_recording(path)) return write_sensor_file(layout::sensor(path), lens);
  // Keys of other models go back to their defaults where the file has them.
  Lens copy = lens;
  TomlValues values;
  for (const Setting& setting : lens_settings(copy)) {
    const bool own = lens_model_has(lens.model, split_key(setting.key).second);
    if (own || has_toml_key(path, setting.key)) {
      values.emplace_back(setting.key, toml_value(setting));
    }
  }
  return edit_toml_file(path, values);
}

namespace {

TomlValues wheel_values(const RobotResult& result) {
  const Wheels& wheels = result.robot.wheels;
  TomlValues values = {{"wheels.track_width_m", toml_number(wheels.track_width_m, 6)},
                       {"wheels.left_scale", toml_number(wheels.left_scale, 6)},
                       {"wheels.right_scale", toml_number(wheels.right_scale, 6)},
                       {"odometry.latency_s", toml_number(result.latency_s, 4)}};
  if (!result.wheels) return values;
  const auto flag = [](bool on) { return on ? "true" : "false"; };
  values.emplace_back("odometry.swap_wheels", flag(result.wheels->swap));
  values.emplace_back("odometry.invert_left", flag(result.wheels->invert_left));
  values.emplace_back("odometry.invert_right", flag(result.wheels->invert_right));
  return values;
}

// Poses become wheel travel by the track width that made them: it is written down before another
// takes its place, for otherwise the one would undo the other.
Result<TomlValues> poses_values(const std::filesystem::path& recording) {
  const auto robot = read_robot_file(layout::robot(recording));
  if (!robot) return robot.error();
  std::error_code code;
  const bool poses = std::filesystem::exists(layout::odometry_tum(recording), code);
  if (!poses || robot->poses_track_width_m > 0.0) return TomlValues{};
  return TomlValues{{"odometry.poses_track_width_m", toml_number(robot->wheels.track_width_m, 9)}};
}

}  // namespace

TomlValues robot_values(const RobotResult& result) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const CameraMount& m = result.robot.mount;
  TomlValues values = wheel_values(result);
  values.emplace_back("mount.x_m", toml_number(m.x_m, 4));
  values.emplace_back("mount.y_m", toml_number(m.y_m, 4));
  values.emplace_back("mount.z_m", toml_number(m.z_m, 4));
  values.emplace_back("mount.roll_deg", toml_number(m.roll_rad * kDegPerRad, 4));
  values.emplace_back("mount.pitch_deg", toml_number(m.pitch_rad * kDegPerRad, 4));
  values.emplace_back("mount.yaw_deg", toml_number(m.yaw_rad * kDegPerRad, 4));
  return values;
}

Status write_robot(const std::filesystem::path& path, const RobotResult& result) {
  if (!is_recording(path)) return edit_toml_file(path, robot_values(result));
  auto sensor = read_sensor_file(layout::sensor(path));
  if (!sensor) return sensor.error();
  sensor->mount = result.robot.mount;
  auto values = poses_values(path);
  if (!values) return values.error();
  for (auto& value : wheel_values(result)) values->push_back(std::move(value));
  const Status written = write_file(layout::sensor(path), format_sensor_file(*sensor));
  return written ? edit_toml_file(layout::robot(path), *values) : written;
}

}  // namespace zenith::tools
