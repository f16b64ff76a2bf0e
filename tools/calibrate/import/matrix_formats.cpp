// A camera matrix and its distortion coefficients: OpenCV's FileStorage and its samples, ROS's
// camera_info as a file and as `topic echo` prints it, Python's dumps of the two arrays.
// Facts: ROS, sensor_msgs/CameraInfo; OpenCV, "Camera calibration and 3D reconstruction", its
// samples' out_camera_data.xml and stereo_calib's intrinsics.yml; omnidir's xi.

#include <algorithm>
#include <array>

#include "platform/base/printable.h"
#include "tools/calibrate/import/formats.h"
#include "tools/calibrate/import/lens_builder.h"

namespace zenith::tools {
namespace {

// Long names stand with anything before or behind them: "leftCameraMatrix", "camera_matrix_1".
constexpr std::array<std::string_view, 8> kLongMatrix = {
    "cameramatrix",        "intrinsicmatrix",  "cameramat",  "cammatrix",
    "intrinsicparameters", "cameraintrinsics", "intrinsics", "intrinsic"};
constexpr std::array<std::string_view, 4> kShortMatrix = {"matrix", "mtx", "k", "m"};
// "coefficents" as many a file has it.
constexpr std::array<std::string_view, 12> kLongDistortion = {"distortioncoefficients",
                                                              "distortioncoefficents",
                                                              "distortioncoeffs",
                                                              "distortioncoeff",
                                                              "distcoefficients",
                                                              "distcoeffs",
                                                              "distcoeff",
                                                              "distcoefs",
                                                              "distcoef",
                                                              "distortionparameters",
                                                              "distortion",
                                                              "coefficients"};
constexpr std::array<std::string_view, 3> kShortDistortion = {"dist", "kc", "d"};
constexpr std::array<std::string_view, 20> kTags = {
    "",     "0",    "1",    "2",     "3",   "4",  "l",     "r",       "left",    "right",
    "cam0", "cam1", "cam2", "color", "rgb", "ir", "depth", "camera0", "camera1", "camera2"};

// What is left of a key without the name: the camera's tag.
template <std::size_t N>
std::optional<std::string> tag_of(const std::string& plain,
                                  const std::array<std::string_view, N>& names, bool any_tag) {
  for (const std::string_view name : names) {
    const std::size_t at = plain.find(name);
    if (at == plain.npos) continue;
    const std::string tag = plain.substr(0, at) + plain.substr(at + name.size());
    if (std::find(kTags.begin(), kTags.end(), tag) != kTags.end()) return tag;
    const bool derived = tag.find("new") != tag.npos || tag.find("opt") != tag.npos ||
                         tag.find("rect") != tag.npos || tag.find("proj") != tag.npos;
    if (any_tag && !derived && tag.size() < 24) return tag;
  }
  return std::nullopt;
}

std::optional<std::string> matrix_tag(const Node& node) {
  const std::string plain = plain_key(node.key);
  auto tag = tag_of(plain, kLongMatrix, true);
  if (!tag) tag = tag_of(plain, kShortMatrix, false);
  if (!tag) return std::nullopt;
  if (node.is_scalar() && node.text.find_first_of(" ,") == node.text.npos) return std::nullopt;
  if (node.is_map()) {
    const Node* data = find(node, {"data"});
    return data != nullptr ? tag : std::nullopt;
  }
  const auto numbers = numbers_of(node);
  if (!numbers) return plain.find("matrix") != plain.npos ? tag : std::nullopt;
  return numbers->size() == 9 || numbers->size() == 12 || plain.find("matrix") != plain.npos
             ? tag
             : std::nullopt;
}

const Node* distortion_with(const Node& map, const std::string& tag) {
  for (const Node& child : map.children) {
    const std::string plain = plain_key(child.key);
    auto found = tag_of(plain, kLongDistortion, true);
    if (!found) found = tag_of(plain, kShortDistortion, false);
    if (!found || *found != tag) continue;
    if (child.is_map() && find(child, {"data"}) == nullptr) continue;
    if (child.is_scalar() && !numbers_of(child)) continue;  // "distortion: plumb_bob"
    return &child;
  }
  return nullptr;
}

// ROS: the intrinsics are of the whole sensor; the images may be a part of it, and binned.
void apply_ros_window(LensBuilder& lens, const Node& map) {
  const double bin_x = lens.number_or(map, {"binningx"}, 0.0);
  const double bin_y = lens.number_or(map, {"binningy"}, 0.0);
  const Node* roi = find(map, {"roi"});
  SensorWindow window;
  if (roi != nullptr && roi->is_map()) {
    window = {lens.number_or(*roi, {"xoffset"}, 0.0), lens.number_or(*roi, {"yoffset"}, 0.0),
              lens.number_or(*roi, {"width"}, 0.0), lens.number_or(*roi, {"height"}, 0.0)};
  }
  lens.apply_window(window, bin_x == 0.0 ? 1.0 : bin_x, bin_y == 0.0 ? 1.0 : bin_y);
}

std::string word_of(const Node& map, const std::string& tag) {
  for (const Node& child : map.children) {
    if (child.is_scalar() && plain_key(child.key) == "distortionmodel" + tag) {
      return printable_start(trimmed(child.text), 60);
    }
  }
  std::string word =
      LensBuilder::text(map, {"distortionmodel", "distortiontype", "distortion", "cameramodel",
                              "model", "lensmodel", "cameratype", "modeltype"});
  // A number is no name.
  if (numbers_in(word) && !word.empty()) word.clear();
  // "pinhole" says nothing about the distortion.
  const std::string plain = plain_key(word);
  if (plain == "pinhole" || plain == "mono" || plain == "camera" || plain == "stereo") word.clear();
  for (const std::string_view key : {"fisheyemodel", "fisheye", "isfisheye", "usefisheye"}) {
    const std::string said = lower(LensBuilder::text(map, {key}));
    if (said == "1" || said == "true" || said == "yes") return "fisheye";
    if (said == "0" || said == "false" || said == "no") return word.empty() ? "plumb_bob" : word;
  }
  return word;
}

ForeignLens lens_of(const Node& map, const Node& matrix, const std::string& tag,
                    const std::string& name, ForeignModel wanted) {
  const std::string key = plain_key(matrix.key);
  const bool ros =
      find(map, {"rectificationmatrix", "projectionmatrix"}) != nullptr ||
      (find(map, {"distortionmodel"}) != nullptr && (key == "k" || key == "cameramatrix"));
  LensBuilder lens(ros ? "ROS camera_info" : "OpenCV", name, wanted);
  lens.size_from(map);
  const auto m = lens.numbers(matrix, matrix.key);
  if (!m.empty() && std::all_of(m.begin(), m.end(), [](double v) { return v == 0.0; })) {
    lens.refuse("the camera matrix is all zeros: the camera that published it is not calibrated");
  }
  lens.set_matrix(m);
  const Node* coefficients = distortion_with(map, tag);
  std::string word = word_of(map, tag);
  const Node* xi = find(map, {"xi" + tag, "xi"});
  if (xi != nullptr) {
    const auto value = lens.numbers(*xi, "xi");
    if (value.size() != 1) lens.refuse("xi: expected one number");
    if (!lens.refused()) {
      lens.set_omni(value[0], coefficients == nullptr ? std::vector<double>(4, 0.0)
                                                      : lens.numbers(*coefficients, "D"));
    }
  } else if (coefficients == nullptr) {
    if (plain_key(word) == "none") {
      lens.set_distortion(word, {});
    } else {
      lens.refuse("there is a camera matrix, but there are no distortion coefficients");
    }
  } else {
    auto d = lens.numbers(*coefficients, coefficients->key);
    if (d.empty() && ros && !lens.refused()) {
      lens.note("the distortion is empty: right for rectified images only");
      d.assign(4, 0.0);
    }
    if (!lens.refused()) lens.set_distortion(word, d);
  }
  if (ros) apply_ros_window(lens, map);
  return lens.take();
}

}  // namespace

ForeignLenses read_matrices(const Node& map, const std::string& name, ForeignModel wanted) {
  ForeignLenses lenses;
  std::vector<std::string> tags;
  for (const Node& child : map.children) {
    const auto tag = matrix_tag(child);
    if (!tag || std::find(tags.begin(), tags.end(), *tag) != tags.end()) continue;
    tags.push_back(*tag);
    std::string own = LensBuilder::text(map, {"cameraname"});
    if (own.empty()) own = name;
    if (const Node* header = find(map, {"header"}); own.empty() && header != nullptr) {
      own = LensBuilder::text(*header, {"frameid"});
    }
    if (!tag->empty()) own += (own.empty() ? "" : ".") + *tag;
    lenses.push_back(lens_of(map, child, *tag, own, wanted));
  }
  return lenses;
}

}  // namespace zenith::tools
