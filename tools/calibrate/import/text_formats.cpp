// Formats that are neither YAML nor JSON nor XML. Facts: OCamCalib's export_data.m; COLMAP's
// "Output format" and camera models; ROS's camera_calibration_parsers (ost.txt); MRPT's
// TCamera::loadFromConfigFile(); Kalibr's results-cam.txt; DSO's camera.txt.

#include <algorithm>
#include <cmath>
#include <map>

#include "platform/base/printable.h"
#include "tools/calibrate/import/formats.h"
#include "tools/calibrate/import/lens_builder.h"

namespace zenith::tools {
namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// Lines that are neither empty nor a comment.
std::vector<std::string_view> content_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (const std::string_view line : lines_of(text)) {
    if (!line.empty() && line.front() != '#') lines.push_back(line);
  }
  return lines;
}

std::string_view first_word(std::string_view line) {
  return line.substr(0, line.find_first_of(" \t"));
}

std::vector<double> cut(const std::vector<double>& values, std::size_t from, std::size_t count) {
  return {values.begin() + static_cast<std::ptrdiff_t>(from),
          values.begin() + static_cast<std::ptrdiff_t>(from + count)};
}

// --- OCamCalib's calib_results.txt --------------------------------------------------------------

std::optional<Result<ForeignLenses>> read_ocam(std::string_view text) {
  if (text.find("polynomial coefficients") == text.npos) return std::nullopt;
  std::vector<std::vector<double>> lines;
  for (const std::string_view line : content_of(text)) {
    auto numbers = numbers_in(line);
    if (!numbers) return Error{"OCamCalib: " + numbers.error().message};
    lines.push_back(std::move(*numbers));
  }
  const auto counted = [&lines](std::size_t i) {
    return lines[i].size() >= 2 && lines[i][0] == static_cast<double>(lines[i].size() - 1);
  };
  if (lines.size() != 5 || !counted(0) || !counted(1) || lines[2].size() != 2 ||
      lines[3].size() != 3 || lines[4].size() != 2) {
    return Error{
        "OCamCalib: expected five lines of numbers: a count and the polynomial, a count and the "
        "inverse polynomial, the centre (row, column), c d e, the size (height, width)"};
  }
  LensBuilder lens("OCamCalib", "", ForeignModel::kAsTheFileSays);
  lens.set_size(lines[4][1], lines[4][0]);
  lens.set_pinhole(1.0, 1.0, lines[2][1], lines[2][0]);
  lens.set_scaramuzza(lines[3][0], lines[3][1], lines[3][2], cut(lines[0], 1, lines[0].size() - 1),
                      cut(lines[1], 1, lines[1].size() - 1));
  return ForeignLenses{lens.take()};
}

// --- COLMAP's cameras.txt -----------------------------------------------------------------------

struct ColmapModel {
  std::string_view name;
  std::string_view word;          // of the distortion; empty: no model here
  std::size_t focal_lengths;      // 1 or 2
  std::vector<int> coefficients;  // where in OpenCV's order the file's next ones go
};

const std::vector<ColmapModel>& colmap_models() {
  static const std::vector<ColmapModel> models = {
      {"SIMPLE_PINHOLE", "none", 1, {}},
      {"PINHOLE", "none", 2, {}},
      {"SIMPLE_RADIAL", "radtan", 1, {0}},
      {"RADIAL", "radtan", 1, {0, 1}},
      {"OPENCV", "radtan", 2, {0, 1, 2, 3}},
      {"FULL_OPENCV", "rational", 2, {0, 1, 2, 3, 4, 5, 6, 7}},
      {"OPENCV_FISHEYE", "equidistant", 2, {0, 1, 2, 3}},
      {"SIMPLE_RADIAL_FISHEYE", "equidistant", 1, {0}},
      {"RADIAL_FISHEYE", "equidistant", 1, {0, 1}},
      {"FOV", "fov", 2, {0}},
      {"THIN_PRISM_FISHEYE", "", 2, {}},
      {"RAD_TAN_THIN_PRISM_FISHEYE", "", 2, {}},
      {"SIMPLE_DIVISION", "", 1, {}},
      {"DIVISION", "", 2, {}},
      {"EQUIRECTANGULAR", "", 0, {}},
  };
  return models;
}

const ColmapModel* colmap_model(std::string_view name) {
  for (const ColmapModel& model : colmap_models()) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

// "ID MODEL WIDTH HEIGHT PARAMS..."
std::optional<ForeignLens> read_colmap_line(std::string_view line) {
  const std::string_view id = first_word(line);
  line = trimmed(line.substr(id.size()));
  const std::string_view word = first_word(line);
  const ColmapModel* model = colmap_model(word);
  const auto behind = numbers_in(line.substr(word.size()));
  if (!numbers_in(id) || (model == nullptr && (!behind || behind->size() < 3))) {
    return std::nullopt;
  }
  LensBuilder lens("COLMAP", std::string(id), ForeignModel::kAsTheFileSays);
  if (model == nullptr) {
    lens.refuse("the model " + printable_start(word, 40) +
                " is none of COLMAP's; expected one such as OPENCV or OPENCV_FISHEYE");
    return lens.take();
  }
  const std::size_t centre = 2 + model->focal_lengths;
  const auto& values = behind;
  if (model->word.empty()) {
    lens.refuse("the model " + std::string(model->name) +
                " is none that a lens here has; run COLMAP with OPENCV_FISHEYE or OPENCV");
  } else if (!values || values->size() != centre + 2 + model->coefficients.size()) {
    lens.refuse(std::string(model->name) + ": expected width, height and " +
                std::to_string(model->focal_lengths + 2 + model->coefficients.size()) +
                " parameters");
  } else {
    lens.set_size((*values)[0], (*values)[1]);
    // COLMAP's first pixel has its centre at (0.5, 0.5).
    lens.set_pinhole((*values)[2], (*values)[1 + model->focal_lengths], (*values)[centre] - 0.5,
                     (*values)[centre + 1] - 0.5);
    lens.note("COLMAP counts pixels from their corner: 0.5 px was taken from the centre");
    std::vector<double> d(model->word == "rational" ? 8 : model->word == "fov" ? 1 : 4, 0.0);
    for (std::size_t i = 0; i < model->coefficients.size(); ++i) {
      d[static_cast<std::size_t>(model->coefficients[i])] = (*values)[centre + 2 + i];
    }
    lens.set_distortion(std::string(model->word), d);
  }
  return lens.take();
}

std::optional<Result<ForeignLenses>> read_colmap(std::string_view text) {
  const auto lines = content_of(text);
  const auto names_a_model = [](std::string_view line) {
    return colmap_model(first_word(trimmed(line.substr(first_word(line).size())))) != nullptr;
  };
  if (!std::any_of(lines.begin(), lines.end(), names_a_model)) return std::nullopt;
  ForeignLenses lenses;
  for (const std::string_view line : lines) {
    auto lens = read_colmap_line(line);
    if (!lens) return std::nullopt;
    lenses.push_back(std::move(*lens));
  }
  return lenses;
}

// --- ROS's ost.txt and MRPT's INI files ---------------------------------------------------------

// What stands in a section: its lines.
using Sections = std::vector<std::pair<std::string, std::vector<std::string_view>>>;

Sections sections_of(std::string_view text) {
  Sections sections;
  for (std::string_view line : lines_of(text)) {
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    if (line.starts_with("//")) continue;
    if (line.front() == '[' && line.back() == ']' && line.find_first_of(",\"{") == line.npos) {
      sections.emplace_back(std::string(trimmed(line.substr(1, line.size() - 2))),
                            std::vector<std::string_view>());
    } else if (!sections.empty()) {
      sections.back().second.push_back(line);
    }
  }
  return sections;
}

// The numbers behind the line that is `title`, up to the next one that is none.
std::vector<double> numbers_behind(const std::vector<std::string_view>& lines,
                                   std::string_view title) {
  std::vector<double> numbers;
  bool inside = false;
  for (const std::string_view line : lines) {
    if (!inside) {
      inside = lower(line) == title;
      continue;
    }
    const auto found = numbers_in(line);
    if (!found) break;
    numbers.insert(numbers.end(), found->begin(), found->end());
  }
  return numbers;
}

ForeignLens ost_lens(const std::string& name, const std::vector<std::string_view>& lines,
                     const std::vector<double>& size, ForeignModel wanted) {
  LensBuilder lens("ROS ost.txt", name, wanted);
  if (size.size() == 2) lens.set_size(size[0], size[1]);
  lens.set_matrix(numbers_behind(lines, "camera matrix"));
  if (!lens.refused()) lens.set_distortion("", numbers_behind(lines, "distortion"));
  return lens.take();
}

ForeignLens mrpt_lens(const std::string& name, const std::vector<std::string_view>& lines,
                      ForeignModel wanted) {
  // "fx = 300  // a comment", "dist = [0.1 0 0 0]"
  Node map{Node::Kind::kMap, {}, {}, {}};
  for (std::string_view line : lines) {
    const std::size_t equals = line.find('=');
    if (equals == line.npos) continue;
    line = line.substr(0, std::min(line.find("//"), line.find(';')));
    if (equals > line.size()) continue;
    map.children.push_back({Node::Kind::kScalar,
                            std::string(trimmed(line.substr(0, equals))),
                            std::string(trimmed(line.substr(equals + 1))),
                            {}});
  }
  const Node* dist = find(map, {"dist"});
  // Others have a key for each coefficient: the ZED camera's file.
  if (dist == nullptr) {
    if (auto plain = read_plain_keys(map, name, wanted)) return *plain;
  }
  LensBuilder lens("MRPT", name, wanted);
  lens.size_from(map);
  const double fx = lens.number(map, {"fx"});
  const double fy = lens.number(map, {"fy"});
  const double cx = lens.number(map, {"cx"});
  lens.set_pinhole(fx, fy, cx, lens.number(map, {"cy"}));
  const std::string word = LensBuilder::text(map, {"distortion", "distortionmodel"});
  if (dist == nullptr && plain_key(word) != "none")
    lens.refuse("there is no dist = [k1 k2 p1 p2 k3]");
  if (lens.refused()) return lens.take();
  auto d = dist == nullptr ? std::vector<double>() : lens.numbers(*dist, "dist");
  // MRPT writes 8 numbers for each model.
  if (plain_key(word) == "none") d.clear();
  lens.set_distortion(word.empty() ? "plumb_bob" : word, d);
  return lens.take();
}

std::optional<Result<ForeignLenses>> read_ini(std::string_view text, ForeignModel wanted) {
  const Sections sections = sections_of(text);
  if (sections.empty()) return std::nullopt;
  // OpenCV's and ROS's YAML has no section at the beginning of a line.
  std::vector<double> size;
  ForeignLenses lenses;
  for (const auto& [name, lines] : sections) {
    const std::string shown = printable_start(name, 40);
    if (lower(name) == "image") {
      size = numbers_behind(lines, "width");
      const auto height = numbers_behind(lines, "height");
      size.insert(size.end(), height.begin(), height.end());
    } else if (std::any_of(lines.begin(), lines.end(),
                           [](std::string_view line) { return lower(line) == "camera matrix"; })) {
      lenses.push_back(ost_lens(shown, lines, size, wanted));
    } else if (std::any_of(lines.begin(), lines.end(), [](std::string_view line) {
                 return plain_key(line.substr(0, line.find('='))) == "fx" &&
                        line.find('=') != line.npos;
               })) {
      lenses.push_back(mrpt_lens(shown, lines, wanted));
    }
  }
  if (lenses.empty()) return std::nullopt;
  return lenses;
}

// --- Kalibr's results-cam.txt -------------------------------------------------------------------

// The list behind "key:", without what stands behind "+-".
std::vector<double> kalibr_list(LensBuilder& lens, std::string_view line) {
  line = line.substr(0, line.find("+-"));
  const auto numbers = numbers_in(line.substr(line.find(':') + 1));
  if (numbers) return *numbers;
  lens.refuse(numbers.error().message);
  return {};
}

ForeignLens kalibr_results_lens(const std::string& name, std::string_view type,
                                const std::vector<double>& d, const std::vector<double>& in,
                                LensBuilder lens) {
  const auto has = [&type](std::string_view word) { return type.find(word) != type.npos; };
  const std::string distortion = has("Equidistant") ? "equidistant"
                                 : has("Fov")       ? "fov"
                                 : has("Distorted") ? "radtan"
                                                    : "none";
  const std::string model = has("Omni")           ? "omni"
                            : has("DoubleSphere") ? "ds"
                            : has("Extended")     ? "eucm"
                            : has("Pinhole")      ? "pinhole"
                                                  : "unknown";
  if (lens.refused()) return lens.take();
  Node intrinsics{Node::Kind::kList, {}, {}, {}};
  Node coefficients = intrinsics;
  const auto fill = [](Node& list, const std::vector<double>& values) {
    for (const double value : values) {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", value);
      list.children.push_back({Node::Kind::kScalar, {}, text, {}});
    }
  };
  fill(intrinsics, in);
  fill(coefficients, d);
  return kalibr_lens({Node::Kind::kMap, {}, {}, {}}, name, "Kalibr results", model,
                     model == "ds" || model == "eucm" ? "none" : distortion, intrinsics,
                     &coefficients, lens.wanted());
}

std::optional<Result<ForeignLenses>> read_kalibr_results(std::string_view text,
                                                         ForeignModel wanted) {
  if (text.find("Camera-system parameters") == text.npos) return std::nullopt;
  ForeignLenses lenses;
  std::string name;
  std::string_view type;
  std::vector<double> distortion;
  for (const std::string_view line : lines_of(text)) {
    LensBuilder problems("Kalibr results", name, wanted);
    if (line.starts_with("cam") && line.ends_with(':')) {
      name = printable_start(line.substr(0, line.find_first_of(" (:")), 40);
      type = {};
    } else if (line.starts_with("type:")) {
      type = line.substr(5);
      distortion.clear();
    } else if (line.starts_with("distortion:")) {
      distortion = kalibr_list(problems, line);
    } else if (line.starts_with("projection:") && !type.empty()) {
      const auto projection = kalibr_list(problems, line);
      lenses.push_back(kalibr_results_lens(name, type, distortion, projection, problems));
    }
  }
  if (lenses.empty()) return Error{"Kalibr's results: expected cameras with type and projection"};
  return lenses;
}

// --- DSO's camera.txt ---------------------------------------------------------------------------

std::optional<Result<ForeignLenses>> read_dso(std::string_view text) {
  const auto lines = content_of(text);
  if (lines.size() < 2 || lines.size() > 6) return std::nullopt;
  const std::string_view word = first_word(lines[0]);
  const bool named = !numbers_in(word).ok();
  const std::string plain = plain_key(word);
  const bool known = plain == "pinhole" || plain == "fov" || plain == "radtan" ||
                     plain == "equidistant" || plain == "kannalabrandt";
  if (named && !known) return std::nullopt;
  const auto numbers = numbers_in(named ? lines[0].substr(word.size()) : lines[0]);
  const auto size = numbers_in(lines[1]);
  if (!numbers || !size || size->size() != 2 || (numbers->size() != 5 && numbers->size() != 8)) {
    return std::nullopt;
  }
  LensBuilder lens("DSO camera.txt", "", ForeignModel::kAsTheFileSays);
  lens.set_size((*size)[0], (*size)[1]);
  const auto& n = *numbers;
  if (n[2] < 1.0 && n[3] < 1.0) {  // parts of the image
    lens.set_pinhole(n[0] * (*size)[0], n[1] * (*size)[1], n[2] * (*size)[0] - 0.5,
                     n[3] * (*size)[1] - 0.5);
  } else {
    lens.set_pinhole(n[0], n[1], n[2], n[3]);
  }
  const auto d = cut(n, 4, n.size() - 4);
  if (n.size() == 5) {
    lens.set_fov(plain == "pinhole" ? 0.0 : d[0]);
  } else {
    lens.set_distortion(named ? std::string(word) : "radtan", d);
  }
  return ForeignLenses{lens.take()};
}

}  // namespace

std::optional<Result<ForeignLenses>> read_plain_text(std::string_view text, ForeignModel wanted) {
  if (auto read = read_ocam(text)) return read;
  if (auto read = read_kalibr_results(text, wanted)) return read;
  if (auto read = read_colmap(text)) return read;
  if (auto read = read_ini(text, wanted)) return read;
  return read_dso(text);
}

}  // namespace zenith::tools
