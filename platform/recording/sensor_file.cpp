#include "platform/recording/sensor_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <Eigen/Geometry>

#include "platform/base/printable.h"
#include "platform/config/problems.h"
#include "platform/config/robot_settings.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

int line_of(const YAML::Node& node) {
  return node.Mark().line + 1;
}

std::string quoted(const YAML::Node& scalar) {
  return printable_start(scalar.Scalar(), 80);
}

// The numbers of a list with `count` entries; empty, and told, when there is no such list.
std::vector<double> read_list(const YAML::Node& node, const std::string& key, std::size_t count,
                              Problems& problems) {
  if (!node) {
    problems.add(0, "missing key " + key);
    return {};
  }
  std::vector<double> values;
  for (const YAML::Node& entry : node) {
    double value = 0.0;
    if (!YAML::convert<double>::decode(entry, value) || !std::isfinite(value)) {
      problems.add(line_of(entry), key + " holds " + (entry.IsScalar() ? quoted(entry) : "a list") +
                                       ", expected finite numbers");
      return {};
    }
    values.push_back(value);
  }
  if (values.size() == count) return values;
  problems.add(line_of(node), key + " holds " + std::to_string(values.size()) +
                                  " numbers, expected " + std::to_string(count));
  return {};
}

void check_word(const YAML::Node& node, const std::string& key, const std::string& expected,
                Problems& problems) {
  if (!node || (node.IsScalar() && node.Scalar() == expected)) return;
  problems.add(line_of(node), key + " is " + (node.IsScalar() ? quoted(node) : "a list") +
                                  ", expected " + expected);
}

void read_lens(const YAML::Node& file, Lens& lens, Problems& problems) {
  check_word(file["distortion_model"], "distortion_model", "equidistant", problems);
  const auto size = read_list(file["resolution"], "resolution", 2, problems);
  if (!size.empty()) {
    const int line = line_of(file["resolution"]);
    problems.check_range(line, "resolution (width)", size[0], 16, 8192);
    problems.check_range(line, "resolution (height)", size[1], 16, 8192);
    lens.width_px = static_cast<int>(std::clamp(size[0], 0.0, 1e6));
    lens.height_px = static_cast<int>(std::clamp(size[1], 0.0, 1e6));
  }
  const auto intrinsics = read_list(file["intrinsics"], "intrinsics", 4, problems);
  if (!intrinsics.empty()) {
    const int line = line_of(file["intrinsics"]);
    problems.check_range(line, "intrinsics (fu)", intrinsics[0], 1, 1e5);
    problems.check_range(line, "intrinsics (fv)", intrinsics[1], 1, 1e5);
    problems.check_range(line, "intrinsics (cu)", intrinsics[2], 0, lens.width_px);
    problems.check_range(line, "intrinsics (cv)", intrinsics[3], 0, lens.height_px);
    lens.fu_px = intrinsics[0];
    lens.fv_px = intrinsics[1];
    lens.cu_px = intrinsics[2];
    lens.cv_px = intrinsics[3];
  }
  const auto k = read_list(file["distortion_coefficients"], "distortion_coefficients", 4, problems);
  if (k.empty()) return;
  std::copy(k.begin(), k.end(), lens.k.begin());
  if (folds(lens)) {
    problems.add(line_of(file["distortion_coefficients"]),
                 "distortion_coefficients fold the image over itself");
  }
}

void read_mount(const YAML::Node& file, CameraMount& mount, Problems& problems) {
  const YAML::Node node = file["T_BS"];
  if (!node || !node.IsMap()) return problems.add(0, "missing key T_BS");
  const auto values = read_list(node["data"], "T_BS.data", 16, problems);
  if (values.empty()) return;
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const int line = line_of(node["data"]);
  const bool rigid = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
                     R.determinant() > 0.0 &&
                     (T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-6;
  if (!rigid) return problems.add(line, "T_BS is no rigid transform");
  if (R(2, 2) < 0.5) {
    return problems.add(line,
                        "T_BS turns the camera away from the ceiling by more than 60 degrees");
  }
  problems.check_range(line, "T_BS (height of the camera)", T(2, 3), -1.0, 10.0);
  mount = mount_of_matrix(T);
}

void read_rate(const YAML::Node& file, double& rate_hz, Problems& problems) {
  const YAML::Node node = file["rate_hz"];
  if (!node) return problems.add(0, "missing key rate_hz");
  if (!YAML::convert<double>::decode(node, rate_hz)) {
    return problems.add(line_of(node), "rate_hz is no number");
  }
  problems.check_range(line_of(node), "rate_hz", rate_hz, 0.1, 1000.0);
}

}  // namespace

Eigen::Matrix4d mount_matrix(const CameraMount& mount) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = (Eigen::AngleAxisd(mount.yaw_rad, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(mount.pitch_rad, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(mount.roll_rad, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  T.topRightCorner<3, 1>() = Eigen::Vector3d(mount.x_m, mount.y_m, mount.z_m);
  return T;
}

CameraMount mount_of_matrix(const Eigen::Matrix4d& T) {
  CameraMount mount;
  mount.x_m = T(0, 3);
  mount.y_m = T(1, 3);
  mount.z_m = T(2, 3);
  mount.roll_rad = std::atan2(T(2, 1), T(2, 2));
  mount.pitch_rad = -std::asin(std::clamp(T(2, 0), -1.0, 1.0));
  mount.yaw_rad = std::atan2(T(1, 0), T(0, 0));
  return mount;
}

Result<SensorFile> read_sensor_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return Error{path.string() + ": missing: a recording holds its camera's calibration there"};
  }
  const auto text = read_text_input(path.string(), kMaxSensorFileBytes);
  if (!text) return text.error();
  return parse_sensor_file(*text, path.string());
}

Result<SensorFile> parse_sensor_file(const std::string& text, const std::string& name) {
  Problems problems(name);
  SensorFile sensor;
  try {
    const YAML::Node file = YAML::Load(text);
    if (!file.IsMap()) return Error{name + ": expected keys and values"};
    read_lens(file, sensor.lens, problems);
    read_mount(file, sensor.mount, problems);
    read_rate(file, sensor.frame_rate_hz, problems);
  } catch (const YAML::Exception& error) {
    problems.add(error.mark.line + 1, error.msg);
  }
  if (problems.any()) return problems.error();
  return sensor;
}

std::string format_sensor_file(const SensorFile& sensor) {
  const Lens& lens = sensor.lens;
  const Eigen::Matrix4d T = mount_matrix(sensor.mount);
  std::string matrix;
  for (int row = 0; row < 4; ++row) {
    char text[128];
    std::snprintf(text, sizeof text, "%s%.12g, %.12g, %.12g, %.12g%s",
                  row == 0 ? "  data: [" : "         ", T(row, 0), T(row, 1), T(row, 2), T(row, 3),
                  row == 3 ? "]\n" : ",\n");
    matrix += text;
  }
  char text[1024];
  std::snprintf(text, sizeof text,
                "# A camera that looks at the ceiling, in the style of ASL and Kalibr.\n"
                "sensor_type: camera\n"
                "# Takes camera coordinates (z out of the lens, x along columns) into base_link\n"
                "# (x forward, y left, z up): the camera's mount.\n"
                "T_BS:\n  cols: 4\n  rows: 4\n%s"
                "rate_hz: %.9g\n"
                "resolution: [%d, %d]\n"
                "camera_model: pinhole\n"
                "intrinsics: [%.12g, %.12g, %.12g, %.12g]  # fu, fv, cu, cv\n"
                "distortion_model: equidistant  # Kannala and Brandt, k1 .. k4\n"
                "distortion_coefficients: [%.12g, %.12g, %.12g, %.12g]\n",
                matrix.c_str(), sensor.frame_rate_hz, lens.width_px, lens.height_px, lens.fu_px,
                lens.fv_px, lens.cu_px, lens.cv_px, lens.k[0], lens.k[1], lens.k[2], lens.k[3]);
  return text;
}

}  // namespace zenith
