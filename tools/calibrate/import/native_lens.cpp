#include "tools/calibrate/import/native_lens.h"

#include <array>
#include <cmath>
#include <numbers>

#include "platform/config/lens_settings.h"
#include "slam/image/lens_projection.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

// An optical axis is near the middle of the image: by less than this share of it, for all lenses
// that sit straight before a whole sensor.
constexpr double kFarFromMiddle = 0.15;
constexpr double kSomewhatFar = 0.10;

std::string size_text(double width, double height) {
  return formatted("%.0f x %.0f", width, height);
}

// The factors that cameras bin and scale by.
double nice(double factor) {
  constexpr std::array<double, 19> kUsual = {1.0 / 8.0, 1.0 / 6.0, 1.0 / 5.0, 1.0 / 4.0, 1.0 / 3.0,
                                             2.0 / 5.0, 1.0 / 2.0, 2.0 / 3.0, 3.0 / 4.0, 4.0 / 3.0,
                                             3.0 / 2.0, 2.0,       2.5,       3.0,       4.0,
                                             5.0,       6.0,       8.0,       16.0};
  for (const double usual : kUsual) {
    if (std::abs(factor / usual - 1.0) < 0.1) return usual;
  }
  return factor;
}

std::string factor_text(double factor) {
  return formatted("%.4g", factor);
}

struct Middle {
  double x = 0.5;  // of the image's width
  double y = 0.5;

  explicit Middle(const Lens& lens)
      : x((lens.cu_px + 0.5) / lens.width_px), y((lens.cv_px + 0.5) / lens.height_px) {}
  double far() const { return std::max(std::abs(x - 0.5), std::abs(y - 0.5)); }
  // The factor that brings the axis to the middle on both sides, when there is one.
  std::optional<double> factor() const {
    if (x <= 0.01 || y <= 0.01) return std::nullopt;
    const double along = 0.5 / x;
    const double across = 0.5 / y;
    if (std::abs(std::log(along / across)) > std::log(1.3)) return std::nullopt;
    return nice(std::sqrt(along * across));
  }
};

// Whether the axis comes near the middle by exchanging width and height: or, what is the same, its
// column and its row.
bool exchange_fits(const Lens& lens) {
  constexpr double kNear = 0.05;
  Lens turned = lens;
  std::swap(turned.width_px, turned.height_px);
  return Middle(turned).far() <= kNear;
}

// A focal length in millimetres, taken for pixels, makes the whole image a dot in the middle.
Status check_focal_length(const Lens& lens) {
  const LensProjection projection(lens);
  const bool perspective = lens.model == LensModel::kRadtan || lens.model == LensModel::kRational;
  const double widest_rad = (perspective ? 85.0 : 110.0) * std::numbers::pi / 180.0;
  const bool ends = projection.limit_rad() < widest_rad;
  const double rho = projection.rho(ends ? projection.limit_rad() * 0.999 : widest_rad);
  const double radius_px = rho * std::min(lens.fu_px, lens.fv_px);
  const double side_px = 0.5 * std::min(lens.width_px, lens.height_px);
  // No perspective lens shows 170 degrees; a fisheye's circle fills a fair part of its sensor.
  if (radius_px >= side_px * (perspective && !ends ? 1.0 : 0.25)) return {};
  return Error{formatted(
      "with a focal length of %.4g px all that the lens shows, up to %.0f degrees from its axis, "
      "lies within %.0f px of its centre, in an image of %s: the focal length seems to be in "
      "millimetres (divide it by the size of a pixel), or of smaller images (--scale)",
      lens.fu_px, std::min(projection.limit_rad(), widest_rad) * 180.0 / std::numbers::pi,
      radius_px, size_text(lens.width_px, lens.height_px).c_str())};
}

Status check_middle(const Lens& lens) {
  const Middle middle(lens);
  if (middle.far() <= kSomewhatFar) return {};
  const bool exchanged = exchange_fits(lens);
  if (middle.far() <= kFarFromMiddle && !exchanged) return {};
  const std::string where = formatted(
      "the optical axis (%.1f, %.1f) lies at %.0f %% of the width and %.0f %% of the "
      "height of %s pixels",
      lens.cu_px, lens.cv_px, 100.0 * middle.x, 100.0 * middle.y,
      size_text(lens.width_px, lens.height_px).c_str());
  if (exchanged) {
    return Error{where +
                 ": width and height seem to be exchanged, or the axis's column and row. If the "
                 "images have " +
                 size_text(lens.height_px, lens.width_px) + ": --size " +
                 std::to_string(lens.height_px) + "x" + std::to_string(lens.width_px) +
                 " --scale 1; otherwise exchange the axis's numbers in the file, or say --scale 1 "
                 "where they are right"};
  }
  if (lens.cu_px < 1.0 && lens.cv_px < 1.0) {
    return Error{where +
                 ": the numbers seem to be shares of the image, or millimetres; expected "
                 "pixels: multiply shares by the width or the height, divide millimetres "
                 "by the size of a pixel"};
  }
  if (const auto factor = middle.factor()) {
    const std::string small =
        size_text(std::round(lens.width_px / *factor), std::round(lens.height_px / *factor));
    std::string tight = small;
    tight.erase(std::remove(tight.begin(), tight.end(), ' '), tight.end());
    return Error{where + ": the numbers belong to images of about " + small +
                 " (binned or scaled). If the robot's images have " +
                 size_text(lens.width_px, lens.height_px) + ": --scale " + factor_text(*factor) +
                 "; if they have " + small + ": --size " + tight + " --scale 1"};
  }
  return Error{where +
               ", expected the middle: the images were cropped, or the calibration failed. "
               "Calibrate the stream that the robot uses; if the numbers are right all the same: "
               "--scale 1"};
}

Error differing_sizes(const Lens& lens, int width, int height) {
  const double along = static_cast<double>(width) / lens.width_px;
  const double across = static_cast<double>(height) / lens.height_px;
  const std::string both = "the file's images have " + size_text(lens.width_px, lens.height_px) +
                           " pixels, --size says " + size_text(width, height);
  if (std::abs(std::log(along / across)) < 0.02) {
    return {both + ": " + factor_text(along) +
            " times as many along each side. If these are the whole images, binned or scaled: "
            "--scale " +
            factor_text(along) +
            " as well; if they are a part, calibrate the stream that the "
            "robot uses"};
  }
  return {both +
          ", which has other proportions: a part of the image. Calibrate the stream that the robot "
          "uses"};
}

// The size of the images, once the numbers are scaled.
Status settle_size(Lens& lens, const Lens& before, const std::string& odd_size,
                   const SizeWish& wish, std::vector<std::string>& notes) {
  if (wish.size) {
    const auto [width, height] = *wish.size;
    const bool known = lens.width_px > 0;
    if (known && !wish.scale && (width != lens.width_px || height != lens.height_px)) {
      return differing_sizes(lens, width, height);
    }
    lens.width_px = width;
    lens.height_px = height;
    return {};
  }
  if (lens.width_px == 0 && !odd_size.empty()) {
    return Error{"the file says '" + odd_size +
                 "' for the size of the images, expected two whole numbers of pixels: say it with "
                 "--size WIDTHxHEIGHT, as they were when the camera was calibrated"};
  }
  if (lens.width_px == 0) {
    return Error{
        "the file does not say how large the images are: say it with --size WIDTHxHEIGHT, as they "
        "were when the camera was calibrated"};
  }
  if (!wish.scale || *wish.scale == 1.0) return {};
  // Numbers that did not fit to the size before, and do now, were what was wrong.
  const bool fits = Middle(lens).far() <= kFarFromMiddle;
  if (fits && Middle(before).far() > kFarFromMiddle) return {};
  lens.width_px = static_cast<int>(std::lround(lens.width_px * *wish.scale));
  lens.height_px = static_cast<int>(std::lround(lens.height_px * *wish.scale));
  notes.push_back("scaled as asked, the size as well: from " +
                  size_text(before.width_px, before.height_px) + " to " +
                  size_text(lens.width_px, lens.height_px) + " pixels");
  return {};
}

void note_doubts(const Lens& lens, std::vector<std::string>& notes) {
  const Middle middle(lens);
  if (middle.far() > kSomewhatFar) {
    notes.push_back(formatted(
        "the optical axis lies at %.0f %% of the width and %.0f %% of the height: right for a "
        "cropped stream; a calibration of another size looks like this as well",
        100.0 * middle.x, 100.0 * middle.y));
  }
  const double ratio = lens.fu_px / lens.fv_px;
  if (ratio > 1.1 || ratio < 1.0 / 1.1) {
    notes.push_back(formatted(
        "fu is %.2f times fv: right for pixels that are not square or a picture scaled to other "
        "proportions; a poor calibration looks like this as well",
        ratio));
  }
  if (const std::string note = lens_note(lens); !note.empty()) notes.push_back(note);
}

}  // namespace

Lens scaled(const Lens& lens, double scale) {
  Lens out = lens;
  out.cu_px = (lens.cu_px + 0.5) * scale - 0.5;
  out.cv_px = (lens.cv_px + 0.5) * scale - 0.5;
  if (lens.model != LensModel::kScaramuzza) {
    out.fu_px *= scale;
    out.fv_px *= scale;
    return out;
  }
  // Its polynomials are in pixels: rho' = s rho, f'(rho') = s f(rho' / s).
  for (std::size_t n = 0; n < out.polynomial.size(); ++n) {
    out.polynomial[n] *= std::pow(scale, 1.0 - static_cast<double>(n));
  }
  for (double& b : out.inverse_polynomial) b *= scale;
  return out;
}

Result<NativeLens> native_lens(const ForeignLens& foreign, const SizeWish& wish) {
  if (!foreign.refused.empty()) return Error{foreign.refused};
  NativeLens out;
  out.notes = foreign.notes;
  out.lens = foreign.lens;
  if (wish.scale) out.lens = scaled(foreign.lens, *wish.scale);
  if (const Status sized = settle_size(out.lens, foreign.lens, foreign.odd_size, wish, out.notes);
      !sized) {
    return sized.error();
  }
  const bool meant = wish.scale && *wish.scale == 1.0;
  const bool finite = std::isfinite(out.lens.cu_px) && std::isfinite(out.lens.cv_px);
  if (finite && !meant && out.lens.fu_px > 0.0) {
    if (const Status middle = check_middle(out.lens); !middle) return middle.error();
  }
  if (const Status good = check_lens(out.lens); !good) return good.error();
  if (const Status good = check_focal_length(out.lens); !good) return good.error();
  note_doubts(out.lens, out.notes);
  return out;
}

AngleOfView angle_of_view(const Lens& lens) {
  const LensProjection projection(lens);
  const auto across = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    std::optional<double> angle_deg;
    const auto one = projection.unproject(a);
    const auto other = projection.unproject(b);
    if (!one || !other) return angle_deg;
    const auto from_axis = [](const Eigen::Vector3d& ray) {
      return std::atan2(ray.head<2>().norm(), ray.z());
    };
    angle_deg = (from_axis(*one) + from_axis(*other)) * 180.0 / std::numbers::pi;
    return angle_deg;
  };
  const double right = lens.width_px - 1.0;
  const double bottom = lens.height_px - 1.0;
  return {across({0.0, lens.cv_px}, {right, lens.cv_px}),
          across({lens.cu_px, 0.0}, {lens.cu_px, bottom}), across({0.0, 0.0}, {right, bottom})};
}

}  // namespace zenith::tools
