#include "tools/calibrate/import/lens_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "platform/base/printable.h"
#include "slam/image/lens/scaramuzza.h"

namespace zenith::tools {
namespace {

enum class Meaning { kUnsaid, kNone, kRadtan, kRational, kEquidistant, kFov, kUnknown };

// The words of ROS, OpenCV, Kalibr, Basalt, ORB-SLAM, RealSense, COLMAP and others.
Meaning meaning_of(const std::string& word) {
  const std::string plain = plain_key(word);
  const auto any = [&plain](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), plain) != words.end();
  };
  if (plain.empty()) return Meaning::kUnsaid;
  if (any({"none", "ideal", "nodistortion", "rectified", "undistorted", "zero"})) {
    return Meaning::kNone;
  }
  if (any({"radtan", "radialtangential", "radtan4", "radtan5", "plumbbob", "brownconrady", "brown",
           "brownconradydistortion", "opencv", "pinhole", "perspective", "radial"})) {
    return Meaning::kRadtan;
  }
  if (any({"rational", "rationalpolynomial", "radtan8", "fullopencv", "pinholefull", "thinprism",
           "thinprismrational", "rationalpolynomialmodel", "tilted"})) {
    return Meaning::kRational;
  }
  if (any({"equidistant", "equi", "equidist", "fisheye", "kannalabrandt", "kannalabrandt4",
           "kannalabrandt8", "kb", "kb4", "kb8", "opencvfisheye", "pinholeequi"})) {
    return Meaning::kEquidistant;
  }
  if (any({"fov", "atan", "fieldofview"})) return Meaning::kFov;
  return Meaning::kUnknown;
}

bool all_zero(const std::vector<double>& values, std::size_t from = 0) {
  return std::all_of(values.begin() + static_cast<std::ptrdiff_t>(std::min(from, values.size())),
                     values.end(), [](double v) { return v == 0.0; });
}

std::string short_number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string count_text(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string count_of(const std::vector<double>& values) {
  return count_text(values.size(), "coefficient");
}

}  // namespace

LensBuilder::LensBuilder(std::string format, std::string camera, ForeignModel wanted)
    : wanted_(wanted) {
  out_.format = std::move(format);
  out_.camera = std::move(camera);
  out_.lens.width_px = 0;
  out_.lens.height_px = 0;
}

double LensBuilder::number(const Node& map, std::initializer_list<std::string_view> names) {
  const Node* node = find(map, names);
  if (node == nullptr) {
    refuse("there is no " + std::string(*names.begin()));
    return 0.0;
  }
  const auto values = numbers(*node, node->key);
  if (values.size() != 1) {
    refuse(printable_start(node->key, 40) + ": expected a number");
    return 0.0;
  }
  return values.front();
}

double LensBuilder::number_or(const Node& map, std::initializer_list<std::string_view> names,
                              double otherwise) {
  return find(map, names) == nullptr ? otherwise : number(map, names);
}

std::vector<double> LensBuilder::numbers(const Node& node, const std::string& what) {
  auto values = numbers_of(node);
  if (values) return std::move(*values);
  refuse(printable_start(what, 40) + ": " + values.error().message);
  return {};
}

std::string LensBuilder::text(const Node& map, std::initializer_list<std::string_view> names) {
  const Node* node = find(map, names);
  return node != nullptr && node->is_scalar() ? printable_start(trimmed(node->text), 60)
                                              : std::string();
}

void LensBuilder::set_size(double width, double height) {
  const auto pixels = [](double size) {
    return size >= 1.0 && size <= 1e6 && size == std::floor(size);
  };
  if (!pixels(width) || !pixels(height)) {
    out_.odd_size = short_number(width) + " x " + short_number(height);
    return;
  }
  out_.lens.width_px = static_cast<int>(width);
  out_.lens.height_px = static_cast<int>(height);
}

void LensBuilder::size_from(const Node& map) {
  const Node* width = find(map, {"imagewidth", "imgwidth", "width", "framewidth", "resolutionwidth",
                                 "camwidth", "cols", "w"});
  const Node* height = find(map, {"imageheight", "imgheight", "height", "frameheight",
                                  "resolutionheight", "camheight", "rows", "h"});
  if (width != nullptr && height != nullptr) {
    const auto w = numbers(*width, width->key);
    const auto h = numbers(*height, height->key);
    if (w.size() == 1 && h.size() == 1) set_size(w[0], h[0]);
    return;
  }
  const Node* both = find(map, {"imagesize", "imgsize", "resolution", "imagedimension",
                                "imagedimensions", "imageresolution", "size"});
  if (both == nullptr) return;
  if (both->is_map() && find(*both, {"data"}) == nullptr) {
    size_from(*both);
    return;
  }
  Node sides = *both;
  if (both->is_scalar()) {  // "640x480"
    std::replace_if(
        sides.text.begin(), sides.text.end(), [](char c) { return c == 'x' || c == 'X'; }, ' ');
  }
  const auto size = numbers_of(sides);
  if (size && size->size() == 2) {
    set_size((*size)[0], (*size)[1]);
  } else if (size) {
    out_.odd_size = count_text(size->size(), "number");
  } else {
    out_.odd_size = printable_start(both->text, 40);
  }
}

void LensBuilder::set_pinhole(double fx, double fy, double cx, double cy) {
  out_.lens.fu_px = fx;
  out_.lens.fv_px = fy;
  out_.lens.cu_px = cx;
  out_.lens.cv_px = cy;
}

void LensBuilder::set_matrix(const std::vector<double>& m) {
  if (m.size() == 4) return set_pinhole(m[0], m[1], m[2], m[3]);
  if (m.size() != 9 && m.size() != 12) {
    return refuse("the camera matrix has " + std::to_string(m.size()) + " numbers, expected 9");
  }
  const std::size_t row = m.size() / 3;
  const std::size_t last = 2 * row;
  if (m[2] == 0.0 && m[row + 2] == 0.0 && m[last] != 0.0) {
    return refuse(
        "the camera matrix is written column by column, as MATLAB does, whose pixels also begin at "
        "1: write its transpose, with 1 less for the centre");
  }
  if (m[row] != 0.0 || m[last] != 0.0 || m[last + 1] != 0.0) {
    return refuse("the camera matrix is not triangular: expected fx s cx, 0 fy cy, 0 0 1");
  }
  if (m[last + 2] != 1.0) {
    return refuse("the camera matrix ends with " + short_number(m[last + 2]) +
                  ", expected 1 in its last row");
  }
  set_pinhole(m[0], m[row + 1], m[2], m[row + 2]);
  out_.skew_px = m[1];
}

void LensBuilder::apply_window(const SensorWindow& window, double binning_x, double binning_y) {
  Lens& lens = out_.lens;
  const auto whole = [](double value) { return value >= 0.0 && value == std::floor(value); };
  const bool sized = lens.width_px > 0;
  if (!whole(window.x_px) || !whole(window.y_px) ||
      (sized && window.x_px + window.width_px > lens.width_px) ||
      (sized && window.y_px + window.height_px > lens.height_px)) {
    return refuse("the region of interest reaches out of the image: correct roi, or set it to 0");
  }
  if (!whole(binning_x) || !whole(binning_y) || binning_x > 64.0 || binning_y > 64.0) {
    return refuse("binning_x and binning_y: expected whole numbers from 0 to 64");
  }
  const bool part = window.width_px > 0.0 && window.height_px > 0.0 &&
                    (window.width_px != lens.width_px || window.height_px != lens.height_px);
  if (part) {
    lens.cu_px -= window.x_px;
    lens.cv_px -= window.y_px;
    set_size(window.width_px, window.height_px);
    note("the file's region of interest was applied: the lens is that of the images in it");
  }
  if (binning_x <= 1.0 && binning_y <= 1.0) return;
  lens.fu_px /= binning_x;
  lens.fv_px /= binning_y;
  lens.cu_px = (lens.cu_px + 0.5) / binning_x - 0.5;
  lens.cv_px = (lens.cv_px + 0.5) / binning_y - 0.5;
  set_size(std::floor(lens.width_px / binning_x), std::floor(lens.height_px / binning_y));
  note("the file's binning was applied: the lens is that of the binned images");
}

void LensBuilder::set_distortion(const std::string& word, const std::vector<double>& coefficients) {
  Meaning meaning = meaning_of(word);
  if (meaning == Meaning::kUnknown) {
    const std::string plain = plain_key(word);
    const bool realsense = plain == "modifiedbrownconrady" || plain == "inversebrownconrady" ||
                           plain == "distortioninversebrownconrady";
    if (!coefficients.empty() && all_zero(coefficients) && realsense) {
      meaning = Meaning::kNone;
    } else if (wanted_ == ForeignModel::kAsTheFileSays) {
      return refuse("the distortion '" + printable_start(word, 60) +
                    "' is none of plumb_bob (radtan), rational_polynomial, equidistant (fisheye), "
                    "fov and none; where it is another word for one, say it with --model");
    }
  }
  const bool fisheye_said = meaning == Meaning::kEquidistant;
  if (wanted_ != ForeignModel::kAsTheFileSays) {
    const bool fisheye = wanted_ == ForeignModel::kFisheye;
    if (meaning != Meaning::kUnsaid && fisheye != fisheye_said) {
      note("the file says '" + printable_start(word, 60) + "'; --model says " +
           (fisheye ? "fisheye" : "pinhole") + ", and was followed");
    }
    meaning = fisheye ? Meaning::kEquidistant
                      : (meaning == Meaning::kRational ? meaning : Meaning::kRadtan);
  }
  const bool guessed = meaning == Meaning::kUnsaid;
  switch (meaning) {
    case Meaning::kNone:
      if (!all_zero(coefficients)) {
        return refuse("the file says there is no distortion, and has " + count_of(coefficients) +
                      " of it; say which they are: --model pinhole or --model fisheye");
      }
      return set_radtan({0.0, 0.0, 0.0, 0.0}, false);
    case Meaning::kEquidistant:
      return set_equidistant(coefficients);
    case Meaning::kFov:
      if (coefficients.empty() || !all_zero(coefficients, 1)) {
        return refuse("the model fov has 1 coefficient, found " + count_of(coefficients));
      }
      return set_fov(coefficients[0]);
    default:
      set_radtan(coefficients, meaning == Meaning::kRational);
      if (guessed && !all_zero(coefficients) && coefficients.size() == 4) {
        note(
            "the file does not name the model of its 4 coefficients: taken as k1 k2 p1 p2 of a "
            "pinhole; if they are k1 k2 k3 k4 of a fisheye, say --model fisheye");
      }
  }
}

void LensBuilder::set_radtan(const std::vector<double>& d, bool rational_named) {
  Lens& lens = out_.lens;
  std::vector<double> c = d;
  // Often there are more zeros than the model has coefficients.
  while (c.size() > 5 && c.back() == 0.0) c.pop_back();
  if (c.size() > 14 || (c.size() > 5 && d.size() < 8)) {
    return refuse("the distortion has " + count_of(d) +
                  ", expected 4, 5 or 8 (12 or 14 when the last are zero)");
  }
  if (c.size() > 12) {
    return refuse(
        "the sensor's tilt (tau) is not zero, and no lens model here has it; calibrate "
        "without it (OpenCV: without CALIB_TILTED_MODEL)");
  }
  if (c.size() > 8) {
    return refuse(
        "the thin prism distortion (s1 .. s4) is not zero, and no lens model here has it; "
        "calibrate without it (OpenCV: without CALIB_THIN_PRISM_MODEL)");
  }
  if (c.size() > 5) c.resize(8, 0.0);
  if (c.size() < 4) {
    return refuse("the distortion has " + count_of(d) +
                  ", expected 4 or more: k1 k2 p1 p2; of a lens without distortion four zeros");
  }
  lens.k = {c[0], c[1], c.size() > 4 ? c[4] : 0.0, 0.0, 0.0, 0.0};
  lens.p = {c[2], c[3]};
  lens.model = LensModel::kRadtan;
  out_.model = all_zero(c) ? "pinhole" : "pinhole, radial and tangential (plumb_bob)";
  if (c.size() == 8) {
    std::copy_n(c.begin() + 5, 3, lens.k.begin() + 3);
    if (c[5] != 0.0 || c[6] != 0.0 || c[7] != 0.0) {
      lens.model = LensModel::kRational;
      out_.model = "pinhole, rational polynomial";
      if (!rational_named) {
        note(
            "8 coefficients are a rational polynomial's (k1 k2 p1 p2 k3 k4 k5 k6), as OpenCV and "
            "ROS compute it, whatever the file calls it");
      }
    }
  }
}

void LensBuilder::set_equidistant(const std::vector<double>& d) {
  if (d.size() < 4 || !all_zero(d, 4)) {
    return refuse("a fisheye lens has the 4 coefficients k1 k2 k3 k4, found " + count_of(d) +
                  (d.size() > 4 ? "; if they are a pinhole's, say --model pinhole" : ""));
  }
  out_.lens.model = LensModel::kEquidistant;
  out_.lens.k = {d[0], d[1], d[2], d[3], 0.0, 0.0};
  out_.model = "fisheye, equidistant (Kannala-Brandt)";
}

void LensBuilder::set_omni(double xi, const std::vector<double>& d) {
  if (d.size() < 4 || !all_zero(d, 4)) {
    return refuse("the omnidirectional model has the 4 coefficients k1 k2 p1 p2, found " +
                  count_of(d));
  }
  out_.lens.model = LensModel::kOmni;
  out_.lens.xi = xi;
  out_.lens.k = {d[0], d[1], 0.0, 0.0, 0.0, 0.0};
  out_.lens.p = {d[2], d[3]};
  out_.model = "omnidirectional (Mei)";
}

void LensBuilder::set_double_sphere(double xi, double alpha) {
  out_.lens.model = LensModel::kDoubleSphere;
  out_.lens.xi = xi;
  out_.lens.alpha = alpha;
  out_.model = "double sphere";
}

void LensBuilder::set_eucm(double alpha, double beta) {
  out_.lens.model = LensModel::kEucm;
  out_.lens.alpha = alpha;
  out_.lens.beta = beta;
  out_.model = "extended unified (EUCM)";
}

void LensBuilder::set_fov(double w_rad) {
  // Its limit for a small w is the pinhole.
  if (std::abs(w_rad) < 1e-9) return set_radtan({0.0, 0.0, 0.0, 0.0}, false);
  out_.lens.model = LensModel::kFov;
  out_.lens.w = w_rad;
  out_.model = "field of view (FOV, ATAN)";
}

void LensBuilder::set_scaramuzza(double c, double d, double e,
                                 const std::vector<double>& polynomial,
                                 const std::vector<double>& inverse) {
  Lens& lens = out_.lens;
  const auto put = [this](const std::vector<double>& from, auto& to, const char* what) {
    std::vector<double> used = from;
    while (!used.empty() && used.back() == 0.0) used.pop_back();
    if (used.size() > to.size()) {
      refuse(std::string("the ") + what + " has " + count_of(used) + ", expected at most " +
             std::to_string(to.size()));
      return;
    }
    to = {};
    std::copy(used.begin(), used.end(), to.begin());
  };
  put(polynomial, lens.polynomial, "polynomial");
  put(inverse, lens.inverse_polynomial, "inverse polynomial");
  lens.model = LensModel::kScaramuzza;
  lens.fu_px = 1.0;
  lens.fv_px = 1.0;
  lens.c = c;
  lens.d = d;
  lens.e = e;
  out_.model = "OCamCalib (Scaramuzza)";
  check_polynomials();
}

// OCamCalib fits the inverse polynomial to the other within a fraction of a pixel.
void LensBuilder::check_polynomials() {
  const Lens& lens = out_.lens;
  if (lens.width_px == 0 || !(lens.polynomial[0] < 0.0)) return;
  if (!scaramuzza::has_inverse(lens)) return;
  constexpr int kSteps = 16;
  const double edge_px = 0.5 * std::min(lens.width_px, lens.height_px);
  for (int i = 1; i <= kSteps; ++i) {
    const double rho_px = edge_px * i / kSteps;
    const double other_px = scaramuzza::rho(lens, scaramuzza::theta_of(lens, rho_px));
    if (!std::isfinite(other_px) || std::abs(other_px - rho_px) < 3.0) continue;
    return note("the two polynomials contradict each other: the point " + short_number(rho_px) +
                " px from the centre lies at " + short_number(other_px) +
                " px by the inverse one, which is used; expected the same within 3 px: were both "
                "written from one calibration?");
  }
}

ForeignLens LensBuilder::take() {
  const Lens& lens = out_.lens;
  if (!std::isfinite(out_.skew_px)) refuse("the skew is not finite");
  // Half an image away from the centre a pixel may not move by more than a thousandth of one.
  const double shift_px = std::abs(out_.skew_px) * 0.5 * std::max(lens.height_px, 480) /
                          std::max(std::abs(lens.fv_px), 1.0);
  if (!refused() && shift_px > 1e-3) {
    refuse("the camera matrix has a skew of " + short_number(out_.skew_px) +
           " px, which no lens model here has; calibrate with the skew fixed to zero (OpenCV's "
           "fisheye: CALIB_FIX_SKEW), or with `zenith calibrate lens`");
  }
  return out_;
}

}  // namespace zenith::tools
