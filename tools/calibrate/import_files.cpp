// Readers of the formats. Which one a file has is found by its keys.

#include <algorithm>
#include <cmath>

#include <yaml-cpp/yaml.h>
#include <nlohmann/json.hpp>

#include "platform/linux/input_file.h"
#include "tools/calibrate/import.h"

namespace zenith::tools {
namespace {

using Lenses = std::vector<ForeignLens>;

std::vector<double> numbers(const YAML::Node& node) {
  std::vector<double> values;
  for (const YAML::Node& entry : node) values.push_back(entry.as<double>());
  return values;
}

// 0, no size, for what no image has.
int pixels_of(double size) {
  return size >= 1.0 && size <= 1e6 ? static_cast<int>(size) : 0;
}

// Kalibr's camchain: cam0, cam1, ...; and sensor.yaml, which has one camera at the top.
ForeignLens kalibr_camera(const std::string& name, const YAML::Node& node) {
  ForeignLens lens;
  lens.format = "Kalibr";
  lens.camera = name;
  std::string distortion = node["distortion_model"].as<std::string>("none");
  if (distortion == "equidistant") distortion = "equi";
  if (distortion == "radial-tangential") distortion = "radtan";
  lens.model = node["camera_model"].as<std::string>("pinhole") + "-" + distortion;
  lens.intrinsics = numbers(node["intrinsics"]);
  if (distortion != "none") {
    lens.distortion = numbers(node["distortion_coeffs"] ? node["distortion_coeffs"]
                                                        : node["distortion_coefficients"]);
  }
  const auto size = numbers(node["resolution"]);
  if (size.size() == 2) {
    lens.width_px = pixels_of(size[0]);
    lens.height_px = pixels_of(size[1]);
  }
  return lens;
}

// Row by row: fu 0 cu 0 fv cv 0 0 1.
std::vector<double> of_matrix(const std::vector<double>& k) {
  if (k.size() != 9) return {};
  return {k[0], k[4], k[2], k[5]};
}

ForeignLens ros_camera(const YAML::Node& node) {
  ForeignLens lens;
  lens.format = "ROS camera_info";
  lens.camera = node["camera_name"].as<std::string>("");
  const std::string model = node["distortion_model"].as<std::string>("");
  lens.model = model == "equidistant" || model == "fisheye" ? "pinhole-equi"
               : model == "plumb_bob"                       ? "pinhole-radtan"
               : model == "rational_polynomial"             ? "pinhole-rational"
                                                            : model;
  lens.width_px = node["image_width"].as<int>(0);
  lens.height_px = node["image_height"].as<int>(0);
  const auto matrix = node["camera_matrix"];
  lens.intrinsics = of_matrix(numbers(matrix["data"]));
  lens.distortion = numbers(node["distortion_coefficients"]["data"]);
  // plumb_bob is often written with more zeros than it has coefficients.
  if (lens.model == "pinhole-radtan") lens.distortion.resize(5, 0.0);
  return lens;
}

Lenses of_yaml(const YAML::Node& file) {
  Lenses lenses;
  if (!file.IsMap()) return lenses;
  if (file["camera_matrix"] && file["distortion_model"]) return {ros_camera(file)};
  if (file["intrinsics"] && file["resolution"]) return {kalibr_camera("", file)};
  for (const auto& entry : file) {
    if (entry.second.IsMap() && entry.second["intrinsics"]) {
      lenses.push_back(kalibr_camera(entry.first.as<std::string>(), entry.second));
    }
  }
  return lenses;
}

YAML::Node first_of(const YAML::Node& file, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (file[name]) return file[name];
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

std::vector<double> of_mat(const YAML::Node& node) {
  if (!node || !node.IsMap()) return {};
  return numbers(node["data"]);
}

int whole_number(const YAML::Node& node, int otherwise) {
  return node && node.IsScalar() ? node.as<int>(otherwise) : otherwise;
}

// Four coefficients are a fisheye's unless the file says otherwise: five and more are not.
Lenses of_opencv(const YAML::Node& file) {
  if (!file.IsMap()) return {};
  ForeignLens lens;
  lens.format = "OpenCV";
  lens.intrinsics =
      of_matrix(of_mat(first_of(file, {"camera_matrix", "Camera_Matrix", "K", "cameraMatrix"})));
  lens.distortion = of_mat(first_of(file, {"distortion_coefficients", "Distortion_Coefficients",
                                           "D", "dist_coeffs", "distCoeffs"}));
  const int fisheye = whole_number(first_of(file, {"fisheye_model", "fisheye"}), -1);
  const bool is_fisheye = fisheye == 1 || (fisheye < 0 && lens.distortion.size() == 4);
  lens.model = is_fisheye                    ? "pinhole-equi"
               : lens.distortion.size() <= 5 ? "pinhole-radtan"
                                             : "pinhole-rational";
  lens.width_px = whole_number(first_of(file, {"image_width", "image_Width", "width"}), 0);
  lens.height_px = whole_number(first_of(file, {"image_height", "image_Height", "height"}), 0);
  if (lens.intrinsics.empty()) return {};
  return {lens};
}

Lenses of_basalt(const std::string& text) {
  const auto file = nlohmann::json::parse(text);
  Lenses lenses;
  const auto& values = file.at("value0");
  for (std::size_t i = 0; i < values.at("intrinsics").size(); ++i) {
    const auto& camera = values["intrinsics"][i];
    const auto& in = camera.at("intrinsics");
    ForeignLens lens;
    lens.format = "Basalt";
    lens.camera = "cam" + std::to_string(i);
    const auto get = [&in](const char* key) { return in.at(key).template get<double>(); };
    const std::string type = camera.at("camera_type");
    lens.model = type;
    if (type == "kb4") {
      lens.model = "pinhole-equi";
      lens.distortion = {get("k1"), get("k2"), get("k3"), get("k4")};
    } else if (type == "ds") {
      lens.model = "ds-none";
      lens.intrinsics = {get("xi"), get("alpha")};
    } else if (type == "eucm") {
      lens.model = "eucm-none";
      lens.intrinsics = {get("alpha"), get("beta")};
    }
    for (const char* key : {"fx", "fy", "cx", "cy"}) lens.intrinsics.push_back(get(key));
    lens.width_px = pixels_of(values.at("resolution").at(i).at(0));
    lens.height_px = pixels_of(values["resolution"][i].at(1));
    lenses.push_back(lens);
  }
  return lenses;
}

Lenses read_any(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') return of_basalt(text);
  // OpenCV's dialect: "%YAML:1.0", which strict parsers refuse, and "!!opencv-matrix".
  const bool directive = text.starts_with("%YAML:");
  if (directive || text.find("!!opencv-matrix") != std::string::npos) {
    return of_opencv(
        YAML::Load(directive ? text.substr(std::min(text.find('\n'), text.size())) : text));
  }
  return of_yaml(YAML::Load(text));
}

}  // namespace

Result<Lenses> parse_foreign_lenses(const std::string& text, const std::string& name) {
  try {
    Lenses lenses = read_any(text);
    if (!lenses.empty()) return lenses;
  } catch (const std::exception& error) {
    return Error{name + ": " + error.what()};
  }
  return Error{
      name +
      ": expected a calibration of Kalibr (camchain), OpenCV, ROS (camera_info) or Basalt, "
      "found none of their keys"};
}

Result<Lenses> read_foreign_lenses(const std::filesystem::path& path) {
  const auto text = read_text_input(path.string(), kMaxCalibrationBytes);
  if (!text) return text.error();
  return parse_foreign_lenses(*text, path.string());
}

}  // namespace zenith::tools
