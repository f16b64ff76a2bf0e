#include "platform/recording/sensor_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <Eigen/Geometry>

#include "platform/base/printable.h"
#include "platform/config/lens_settings.h"
#include "platform/config/problems.h"
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

std::string word_of(const YAML::Node& node, const char* otherwise) {
  if (!node) return otherwise;
  return node.IsScalar() ? node.Scalar() : "a list";
}

// A lens as the file names it: Kalibr's and ASL's words.
struct NamedModel {
  LensModel model;
  const char* camera;
  std::vector<const char*> distortions;  // the first is written
  std::size_t projection_numbers = 0;    // in front of fu, fv, cu, cv
};

const std::vector<NamedModel>& named_models() {
  static const std::vector<NamedModel> models = {
      {LensModel::kEquidistant, "pinhole", {"equidistant", "equi"}},
      {LensModel::kRadtan, "pinhole", {"radial-tangential", "radtan", "plumb_bob", "none"}},
      {LensModel::kRational, "pinhole", {"rational_polynomial", "rational"}},
      {LensModel::kFov, "pinhole", {"fov"}},
      {LensModel::kDoubleSphere, "ds", {"none"}, 2},
      {LensModel::kEucm, "eucm", {"none"}, 2},
      {LensModel::kOmni, "omni", {"radial-tangential", "radtan", "none"}, 1},
      {LensModel::kScaramuzza, "scaramuzza", {"none"}, 3},
  };
  return models;
}

std::string camera_word(const YAML::Node& file) {
  return word_of(file["camera_model"], "pinhole");
}

std::string distortion_word(const YAML::Node& file) {
  return word_of(file["distortion_model"], camera_word(file) == "pinhole" ? "equidistant" : "none");
}

const NamedModel* find_model(const YAML::Node& file, Problems& problems) {
  const std::string camera = camera_word(file);
  const std::string distortion = distortion_word(file);
  std::string known;
  for (const NamedModel& named : named_models()) {
    for (const char* word : named.distortions) {
      if (camera == named.camera && distortion == word) return &named;
    }
    known += (known.empty() ? "" : ", ") + std::string(named.camera) + " with " +
             named.distortions.front();
  }
  const YAML::Node at = file["distortion_model"] ? file["distortion_model"] : file["camera_model"];
  problems.add(line_of(at), "camera_model " + printable_start(camera, 80) +
                                " with distortion_model " + printable_start(distortion, 80) +
                                " is unknown; known: " + known);
  return nullptr;
}

// A list that may be missing, of at most as many numbers as `to` has.
void read_coefficients(const YAML::Node& file, const char* key, std::span<double> to,
                       Problems& problems) {
  const YAML::Node node = file[key];
  if (!node) return;
  if (node.size() > to.size()) {
    problems.add(line_of(node), std::string(key) + " holds " + std::to_string(node.size()) +
                                    " numbers, expected " + std::to_string(to.size()) + " at most");
    return;
  }
  const auto values = read_list(node, key, node.size(), problems);
  std::copy(values.begin(), values.end(), to.begin());
}

// Radtan's fifth coefficient may be left out; the last six of rational's 14 (thin prism, tilt) must
// be zero.
void read_distortion(const YAML::Node& file, const NamedModel& named, Lens& lens,
                     Problems& problems) {
  const auto numbers = lens_numbers(lens.model);
  const std::size_t wanted = numbers.size() - named.projection_numbers;
  const YAML::Node node = file["distortion_coefficients"];
  if (wanted == 0 || distortion_word(file) == "none") return;
  std::size_t count = wanted;
  if (node && lens.model == LensModel::kRadtan && node.size() == 4) count = 4;
  if (node && lens.model == LensModel::kRational && (node.size() == 12 || node.size() == 14)) {
    count = node.size();
  }
  const auto values = read_list(node, "distortion_coefficients", count, problems);
  if (values.empty()) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < wanted) {
      numbers[named.projection_numbers + i].at(lens) = values[i];
    } else if (values[i] != 0.0) {
      problems.add(line_of(node),
                   "distortion_coefficients: thin prism and tilt (the numbers "
                   "behind the eighth) are not known here, expected zeros");
      return;
    }
  }
}

// The line of the file that a problem of the lens stands in, and how the file calls it.
void add_problem(const YAML::Node& file, const NamedModel& named, const LensProblem& problem,
                 Problems& problems) {
  const auto in = [&](const char* key, const std::string& name) {
    problems.add(file[key] ? line_of(file[key]) : 0, name + problem.what);
  };
  if (problem.key == "width_px") return in("resolution", "resolution (width)");
  if (problem.key == "height_px") return in("resolution", "resolution (height)");
  if (problem.key.ends_with("polynomial")) return in(problem.key.c_str(), problem.key);
  const auto numbers = lens_numbers(named.model);
  const auto found = std::find_if(numbers.begin(), numbers.end(), [&](const LensNumber& number) {
    return number.key == problem.key;
  });
  const bool distortion = found != numbers.end() &&
                          found - numbers.begin() >= static_cast<int>(named.projection_numbers);
  const std::string short_key =
      problem.key.ends_with("_px") ? problem.key.substr(0, 2) : problem.key;
  if (distortion)
    return in("distortion_coefficients", "distortion_coefficients (" + short_key + ")");
  in("intrinsics", "intrinsics (" + short_key + ")");
}

void read_lens(const YAML::Node& file, Lens& lens, Problems& problems) {
  const NamedModel* named = find_model(file, problems);
  if (named == nullptr) return;
  lens.model = named->model;
  const auto size = read_list(file["resolution"], "resolution", 2, problems);
  if (!size.empty()) {
    lens.width_px = static_cast<int>(std::clamp(size[0], 0.0, 1e6));
    lens.height_px = static_cast<int>(std::clamp(size[1], 0.0, 1e6));
  }
  const std::size_t extra = named->projection_numbers;
  const auto intrinsics = read_list(file["intrinsics"], "intrinsics", extra + 4, problems);
  if (!intrinsics.empty()) {
    const auto numbers = lens_numbers(lens.model);
    for (std::size_t i = 0; i < extra; ++i) numbers[i].at(lens) = intrinsics[i];
    lens.fu_px = intrinsics[extra];
    lens.fv_px = intrinsics[extra + 1];
    lens.cu_px = intrinsics[extra + 2];
    lens.cv_px = intrinsics[extra + 3];
  }
  read_distortion(file, *named, lens, problems);
  if (lens.model == LensModel::kScaramuzza) {
    read_coefficients(file, "polynomial", lens.polynomial, problems);
    read_coefficients(file, "inverse_polynomial", lens.inverse_polynomial, problems);
  }
  if (size.empty() || intrinsics.empty()) return;
  for (const LensProblem& problem : lens_problems(lens)) {
    add_problem(file, *named, problem, problems);
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

namespace {

std::string list_text(std::span<const double> numbers) {
  std::string text = "[";
  for (const double number : numbers) {
    char one[32];
    std::snprintf(one, sizeof one, "%s%.12g", text.size() > 1 ? ", " : "", number);
    text += one;
  }
  return text + "]";
}

template <std::size_t N>
std::span<const double> without_zeros(const std::array<double, N>& list) {
  std::span<const double> numbers = list;
  while (!numbers.empty() && numbers.back() == 0.0) numbers = numbers.first(numbers.size() - 1);
  return numbers;
}

// The lens's lines, in the words of named_models().
std::string lens_lines(const Lens& lens) {
  const auto& models = named_models();
  const NamedModel& named = *std::find_if(
      models.begin(), models.end(), [&](const NamedModel& m) { return m.model == lens.model; });
  std::vector<double> intrinsics;
  std::vector<double> distortion;
  std::string names;
  std::string distortion_names;
  for (const LensNumber& number : lens_numbers(lens.model)) {
    const bool projects = intrinsics.size() < named.projection_numbers;
    (projects ? intrinsics : distortion).push_back(number.of(lens));
    std::string& list = projects ? names : distortion_names;
    list += (list.empty() ? "" : ", ") + std::string(number.key);
  }
  for (const double value : {lens.fu_px, lens.fv_px, lens.cu_px, lens.cv_px}) {
    intrinsics.push_back(value);
  }
  names += (names.empty() ? "" : ", ") + std::string("fu, fv, cu, cv");
  if (lens.model == LensModel::kEquidistant) distortion_names = "Kannala and Brandt, k1 .. k4";
  std::string text = "camera_model: " + std::string(named.camera) +
                     "\nintrinsics: " + list_text(intrinsics) + "  # " + names +
                     "\ndistortion_model: " + named.distortions.front();
  if (!distortion.empty()) {
    text += "  # " + distortion_names + "\ndistortion_coefficients: " + list_text(distortion);
  }
  text += "\n";
  if (lens.model == LensModel::kScaramuzza) {
    text += "polynomial: " + list_text(without_zeros(lens.polynomial)) +
            "\ninverse_polynomial: " + list_text(without_zeros(lens.inverse_polynomial)) + "\n";
  }
  return text;
}

}  // namespace

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
                "resolution: [%d, %d]\n",
                matrix.c_str(), sensor.frame_rate_hz, lens.width_px, lens.height_px);
  return text + lens_lines(lens);
}

}  // namespace zenith
