#pragma once
// sensor.yaml of a camera, in the style of ASL and Kalibr: lens, rate, and the mount as T_BS, which
// takes camera coordinates into base_link. Keys that are not needed here are left alone.

#include <filesystem>
#include <string>

#include <Eigen/Core>

#include "platform/base/result.h"
#include "slam/robot.h"

namespace zenith {

struct SensorFile {
  Lens lens;
  CameraMount mount;
  double frame_rate_hz = 15.0;
};

inline constexpr std::size_t kMaxSensorFileBytes = std::size_t{64} << 10U;

// `name` stands for the file in messages.
Result<SensorFile> parse_sensor_file(const std::string& text, const std::string& name);
Result<SensorFile> read_sensor_file(const std::filesystem::path& path);
std::string format_sensor_file(const SensorFile& sensor);

// R_base_camera = Rz(yaw) Ry(pitch) Rx(roll), and the position of the camera.
Eigen::Matrix4d mount_matrix(const CameraMount& mount);
CameraMount mount_of_matrix(const Eigen::Matrix4d& T_base_camera);

}  // namespace zenith
