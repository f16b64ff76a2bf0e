#include "platform/config/lens_settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "slam/image/lens_extent.h"

namespace zenith {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMostSide_px = 8192.0;
constexpr double kLeastSide_px = 16.0;
// Less of the world than this, from the axis, maps no ceiling: the numbers are wrong.
constexpr double kLeastView_deg = 5.0;
constexpr double kLeastViewFolded_deg = 30.0;

struct ModelEntry {
  std::string_view name;
  std::string_view numbers;  // in order
};

// In the order of LensModel.
constexpr std::array<ModelEntry, kLensModels> kModels = {{
    {"equidistant", "k1 k2 k3 k4"},
    {"radtan", "k1 k2 p1 p2 k3"},
    {"rational", "k1 k2 p1 p2 k3 k4 k5 k6"},
    {"fov", "w"},
    {"double_sphere", "xi alpha"},
    {"eucm", "alpha beta"},
    {"omni", "xi k1 k2 p1 p2"},
    {"scaramuzza", "c d e"},
}};

constexpr double kMostRadial = 1000.0;

constexpr auto kNumbers = std::to_array<LensNumber>({
    {"k1", -kMostRadial, kMostRadial, "radial distortion",
     [](Lens& l) -> double& { return l.k[0]; }},
    {"k2", -kMostRadial, kMostRadial, "the same", [](Lens& l) -> double& { return l.k[1]; }},
    {"k3", -kMostRadial, kMostRadial, "the same", [](Lens& l) -> double& { return l.k[2]; }},
    {"k4", -kMostRadial, kMostRadial, "the same", [](Lens& l) -> double& { return l.k[3]; }},
    {"k5", -kMostRadial, kMostRadial, "the same", [](Lens& l) -> double& { return l.k[4]; }},
    {"k6", -kMostRadial, kMostRadial, "the same", [](Lens& l) -> double& { return l.k[5]; }},
    {"p1", -1, 1, "decentring (\"tangential\") distortion",
     [](Lens& l) -> double& { return l.p[0]; }},
    {"p2", -1, 1, "the same", [](Lens& l) -> double& { return l.p[1]; }},
    {"xi", -0.99, 10, "double_sphere: between the spheres; omni: the mirror's",
     [](Lens& l) -> double& { return l.xi; }},
    {"alpha", 0, 1, "double_sphere, eucm: sphere 0 .. pinhole 1 of the ray's share",
     [](Lens& l) -> double& { return l.alpha; }},
    {"beta", 0.01, 100, "eucm: the ellipsoid's", [](Lens& l) -> double& { return l.beta; }},
    {"w", 0, 3.1, "fov: the angle that the ideal lens shows",
     [](Lens& l) -> double& { return l.w; }},
    {"c", 0.1, 10, "scaramuzza: the sensor's affine map, see docs/calibration.md",
     [](Lens& l) -> double& { return l.c; }},
    {"d", -1, 1, "the same", [](Lens& l) -> double& { return l.d; }},
    {"e", -1, 1, "the same", [](Lens& l) -> double& { return l.e; }},
});

const ModelEntry& entry_of(LensModel model) {
  return kModels[static_cast<std::size_t>(model) % kModels.size()];
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

std::string number_text(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string degrees_text(double angle_rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f degrees", angle_rad * kDegPerRad);
  return text;
}

// Coefficients up to the last that counts.
template <std::size_t N>
std::size_t length_of(const std::array<double, N>& a) {
  std::size_t length = N;
  while (length > 0 && a[length - 1] == 0.0) --length;
  return length;
}

// Collects what is wrong with single numbers.
class NumberChecks {
 public:
  void range(std::string_view key, double value, double min, double max) {
    if (std::isfinite(value) && value >= min && value <= max) return;
    char what[96];
    std::snprintf(what, sizeof what, " is %g, expected %g .. %g", value, min, max);
    add(key, what);
  }
  void add(std::string_view key, std::string what) {
    problems.push_back({std::string(key), std::move(what)});
  }

  std::vector<LensProblem> problems;
};

void check_frame(const Lens& lens, NumberChecks& checks) {
  checks.range("width_px", lens.width_px, kLeastSide_px, kMostSide_px);
  checks.range("height_px", lens.height_px, kLeastSide_px, kMostSide_px);
  checks.range("fu_px", lens.fu_px, 1, 1e5);
  checks.range("fv_px", lens.fv_px, 1, 1e5);
  const auto centre = [&](const char* key, double at, int side_px) {
    checks.range(key, at, 0, kMostSide_px);
    if (at >= side_px && at <= kMostSide_px) checks.add(key, " lies outside of the frame");
  };
  centre("cu_px", lens.cu_px, lens.width_px);
  centre("cv_px", lens.cv_px, lens.height_px);
}

void check_numbers(const Lens& lens, NumberChecks& checks) {
  const Lens untouched;
  for (const LensNumber& number : kNumbers) {
    const double value = number.of(lens);
    if (lens_model_has(lens.model, number.key)) {
      checks.range(number.key, value, number.min, number.max);
    } else if (value != number.of(untouched)) {
      checks.add(number.key, " is not a number of the model " +
                                 std::string(lens_model_name(lens.model)) + ", which has " +
                                 std::string(entry_of(lens.model).numbers));
    }
  }
}

void check_relations(const Lens& lens, NumberChecks& checks) {
  if (lens.model == LensModel::kFov && lens.w < 0.001) {
    checks.add("w", " is " + number_text(lens.w) + ", expected an angle; a pinhole is radtan's");
  }
}

void check_polynomials(const Lens& lens, NumberChecks& checks) {
  const auto finite = [](const auto& a) {
    return std::all_of(a.begin(), a.end(), [](double v) { return std::isfinite(v); });
  };
  if (!finite(lens.polynomial)) checks.add("polynomial", " holds what is no number");
  if (!finite(lens.inverse_polynomial)) {
    checks.add("inverse_polynomial", " holds what is no number");
  }
  const bool given = length_of(lens.polynomial) + length_of(lens.inverse_polynomial) > 0;
  if (lens.model != LensModel::kScaramuzza) {
    if (given) checks.add("polynomial", " is the model scaramuzza's alone");
    return;
  }
  if (!given) checks.add("polynomial", " is missing: [a0, a1, a2, ..]");
  if (lens.polynomial[0] > 0.0) {
    checks.add("polynomial", " begins with " + number_text(lens.polynomial[0]) +
                                 ", expected a number below zero, as OCamCalib writes it");
  }
  if (lens.fu_px != 1.0 || lens.fv_px != 1.0) {
    checks.add("fu_px", " and fv_px are expected to be 1: the polynomial is in pixels");
  }
  if (std::abs(lens.c - lens.d * lens.e) < 0.05) checks.add("c", ", d and e fold the sensor flat");
}

// What the key of a curve is that is wrong as a whole.
std::string curve_key(LensModel model) {
  if (model == LensModel::kScaramuzza) return "polynomial";
  return std::string(words_of(entry_of(model).numbers).front());
}

void check_view(const Lens& lens, NumberChecks& checks) {
  const LensProjection projection(lens);
  const LensExtent extent = lens_extent(projection);
  const double widest_deg = extent.widest_rad * kDegPerRad;
  if (!extent.whole && projection.folds() && widest_deg < kLeastViewFolded_deg) {
    checks.add(curve_key(lens.model),
               " and the other numbers (" + std::string(entry_of(lens.model).numbers) +
                   ") fold the image over itself at " + degrees_text(projection.limit_rad()) +
                   " from the axis, inside of the image; expected " +
                   number_text(kLeastViewFolded_deg) + " or more");
  } else if (!(widest_deg >= kLeastView_deg)) {
    checks.add("fu_px", " and the other numbers show the world up to " +
                            degrees_text(extent.widest_rad) + " from the axis; expected " +
                            number_text(kLeastView_deg) + " or more");
  }
}

}  // namespace

std::string_view lens_model_name(LensModel model) {
  return entry_of(model).name;
}

std::optional<LensModel> find_lens_model(std::string_view name) {
  for (std::size_t i = 0; i < kModels.size(); ++i) {
    if (kModels[i].name == name) return static_cast<LensModel>(i);
  }
  return std::nullopt;
}

std::vector<std::string> lens_model_names() {
  std::vector<std::string> names;
  for (const ModelEntry& model : kModels) names.emplace_back(model.name);
  return names;
}

std::vector<LensNumber> lens_numbers(LensModel model) {
  std::vector<LensNumber> numbers;
  for (const std::string_view key : words_of(entry_of(model).numbers)) {
    const auto* found = std::find_if(kNumbers.begin(), kNumbers.end(),
                                     [key](const LensNumber& n) { return n.key == key; });
    if (found != kNumbers.end()) numbers.push_back(*found);
  }
  return numbers;
}

bool lens_model_has(LensModel model, std::string_view key) {
  if (key == "model" || key.ends_with("_px")) return true;
  if (key.ends_with("polynomial")) return model == LensModel::kScaramuzza;
  const auto numbers = words_of(entry_of(model).numbers);
  return std::find(numbers.begin(), numbers.end(), key) != numbers.end();
}

Settings lens_settings(Lens& lens) {
  Settings settings = {
      {"lens.model", "", 0, 0, "whose numbers these are: the table in docs/calibration.md",
       choice_of(lens.model, lens_model_names())},
      {"lens.width_px", "px", kLeastSide_px, kMostSide_px,
       "size of the frames; the camera must offer it", &lens.width_px},
      {"lens.height_px", "px", kLeastSide_px, kMostSide_px, "the same", &lens.height_px},
      {"lens.fu_px", "px", 1, 1e5, "focal length along columns", &lens.fu_px},
      {"lens.fv_px", "px", 1, 1e5, "focal length along rows", &lens.fv_px},
      {"lens.cu_px", "px", 0, kMostSide_px,
       "column of the optical axis; the first pixel's centre is 0", &lens.cu_px},
      {"lens.cv_px", "px", 0, kMostSide_px, "row of the optical axis", &lens.cv_px},
  };
  for (const LensNumber& number : kNumbers) {
    std::string models;
    for (const ModelEntry& model : kModels) {
      const auto words = words_of(model.numbers);
      if (std::find(words.begin(), words.end(), number.key) == words.end()) continue;
      models += (models.empty() ? "" : ", ") + std::string(model.name);
    }
    std::string text(number.text);
    if (text.find(':') == std::string::npos) text = models + ": " + text;
    settings.push_back({"lens." + std::string(number.key), "", number.min, number.max,
                        std::move(text), &number.at(lens)});
  }
  settings.push_back({"lens.polynomial", "", 0, 0,
                      "scaramuzza: [a0, a1, a2, ..] as OCamCalib writes it, in pixels",
                      std::span<double>(lens.polynomial)});
  settings.push_back({"lens.inverse_polynomial", "", 0, 0,
                      "scaramuzza: [b0, b1, ..], where the calibration gives it; empty: solved",
                      std::span<double>(lens.inverse_polynomial)});
  return settings;
}

std::vector<LensProblem> lens_problems(const Lens& lens) {
  NumberChecks checks;
  check_frame(lens, checks);
  check_numbers(lens, checks);
  check_relations(lens, checks);
  check_polynomials(lens, checks);
  // What a number out of its range brings about elsewhere would only hide it.
  if (checks.problems.empty()) check_view(lens, checks);
  return std::move(checks.problems);
}

Status check_lens(const Lens& lens) {
  std::string text;
  for (const LensProblem& problem : lens_problems(lens)) {
    text += (text.empty() ? "" : "\n") + problem.key + problem.what;
  }
  if (text.empty()) return {};
  return Error{text};
}

std::string lens_note(const Lens& lens) {
  const LensProjection projection(lens);
  // Farther out than this a fisheye's image circle may well end.
  constexpr double kUsed_rad = 0.5 * std::numbers::pi;
  if (projection.limit_rad() >= kUsed_rad || lens_extent(projection).whole) return {};
  return std::string("the lens's curve ") + (projection.folds() ? "folds back" : "ends") + " at " +
         degrees_text(projection.limit_rad()) +
         " from its axis, inside of the image: what lies farther out is not used";
}

std::string lens_text(const Lens& lens) {
  std::string text = std::string(lens_model_name(lens.model)) + ", " +
                     std::to_string(lens.width_px) + " x " + std::to_string(lens.height_px) + " px";
  Lens copy = lens;
  for (const Setting& setting : lens_settings(copy)) {
    const std::string key = split_key(setting.key).second;
    if (key == "model" || key == "width_px" || key == "height_px") continue;
    if (!lens_model_has(lens.model, key)) continue;
    text += (key == "fu_px" || !key.ends_with("_px") ? ", " : " ") +
            (key.ends_with("_px") ? key.substr(0, 2) : key) + " " + toml_value(setting);
  }
  return text;
}

}  // namespace zenith
