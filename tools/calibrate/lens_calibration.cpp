#include "tools/calibrate/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "platform/config/lens_settings.h"
#include "tools/calibrate/median.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr std::size_t kLeastViews = 4;
constexpr std::size_t kGoodViews = 12;
// A view this much worse than the typical one shows a bent board, motion or a wrong corner.
constexpr double kOutlierFactor = 2.5;
constexpr double kOutlierFloor_px = 0.5;

BoardView view_of(const Detection& detection, const Target& target) {
  BoardView view;
  for (std::size_t i = 0; i < detection.ids.size(); ++i) {
    view.board_m.push_back(target.corner_m(detection.ids[i]));
    view.seen_px.push_back(detection.corners_px[i]);
  }
  return view;
}

std::vector<double> view_errors(const LensFit& fit, const std::vector<BoardView>& views) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < views.size(); ++i) {
    errors.push_back(rms_of(residuals(fit.lens, fit.poses[i], views[i])));
  }
  return errors;
}

// The used views and which image each came from.
struct Selection {
  std::vector<BoardView> views;
  std::vector<std::size_t> image;

  void remove(std::size_t i) {
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(i));
    image.erase(image.begin() + static_cast<std::ptrdiff_t>(i));
  }
};

Selection select(const std::vector<SeenBoard>& boards, const Target& target,
                 std::vector<ImageReport>& reports) {
  Selection selection;
  for (const SeenBoard& board : boards) {
    ImageReport report;
    report.name = board.name;
    if (board.found.ok()) {
      report.corners = board.found->ids.size();
      selection.views.push_back(view_of(*board.found, target));
      selection.image.push_back(reports.size());
    } else {
      report.refused = board.found.error().message;
    }
    reports.push_back(std::move(report));
  }
  return selection;
}

// Views that no pose explains with any plain lens never reach the fit.
void drop_planeless(Selection& selection, int width_px, int height_px,
                    std::vector<ImageReport>& reports) {
  const Lens plain{width_px,        height_px, 0.3 * width_px, 0.3 * width_px, 0.5 * width_px,
                   0.5 * height_px, {}};
  for (std::size_t i = selection.views.size(); i-- > 0;) {
    if (pose_from_rays(plain, selection.views[i])) continue;
    reports[selection.image[i]].refused = "its corners lie on no plane";
    selection.remove(i);
  }
}

Error too_few(std::size_t usable, std::size_t given) {
  return {"expected " + std::to_string(kLeastViews) + " or more usable images, found " +
          std::to_string(usable) + " of " + std::to_string(given) +
          "; take 20 to 40, and check the board's kind and number of squares"};
}

// Fits, and leaves out whole groups of bad views until none stands out.
Result<LensFit> fit_without_outliers(Selection& selection, int width_px, int height_px,
                                     std::vector<ImageReport>& reports) {
  const std::size_t given = reports.size();
  for (;;) {
    if (selection.views.size() < kLeastViews) return too_few(selection.views.size(), given);
    auto fit = fit_lens(selection.views, width_px, height_px);
    if (!fit) {
      return Error{"no fisheye lens explains these corners; check the board's kind and squares"};
    }
    const std::vector<double> errors = view_errors(*fit, selection.views);
    const double limit = std::max(kOutlierFloor_px, kOutlierFactor * median(errors));
    bool dropped = false;
    // Only those about as bad as the worst: it pulls at the others.
    const double worst = *std::max_element(errors.begin(), errors.end());
    for (std::size_t i = errors.size(); i-- > 0;) {
      if (errors[i] <= limit || errors[i] < 0.5 * worst) continue;
      ImageReport& report = reports[selection.image[i]];
      report.rms_px = errors[i];
      report.refused = formatted(
          "its corners are off by %.2f px, the others' by %.2f: moved while "
          "exposed, a bent board, or wrong corners",
          errors[i], median(errors));
      selection.remove(i);
      dropped = true;
    }
    if (dropped) continue;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      reports[selection.image[i]].rms_px = errors[i];
    }
    return *fit;
  }
}

double largest_lean_deg(const LensCalibration& c) {
  // Between a board's normal and the ray to its middle.
  double largest = 0.0;
  for (std::size_t i = 0; i < c.views.size(); ++i) {
    const BoardPose& pose = c.fit.poses[i];
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const auto& p : c.views[i].board_m) middle += p;
    middle /= static_cast<double>(c.views[i].board_m.size());
    const Eigen::Vector3d ray = pose.in_camera(middle).normalized();
    const double facing = std::abs(ray.dot(pose.R_camera_board.col(2)));
    largest = std::max(largest, std::acos(std::min(1.0, facing)) * 180.0 / std::numbers::pi);
  }
  return largest;
}

void judge_coverage(const Coverage& coverage, Judgement& judgement) {
  const double share = static_cast<double>(coverage.covered) / std::max(1, coverage.visible);
  if (share < 0.9) {
    const auto names = missing_cells(coverage);
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 6); ++i) {
      list += (i > 0 ? "; " : "") + names[i];
    }
    if (names.size() > 6) list += formatted("; and %zu more", names.size() - 6);
    judgement.lower(
        share < 0.6 ? Worth::kAgain : Worth::kUsable,
        formatted("%d of %d parts of the image have too few corners (coverage.png): hold "
                  "the board there: ",
                  coverage.visible - coverage.covered, coverage.visible) +
            list);
  }
  if (coverage.farthest_deg < 60.0) {
    judgement.lower(
        coverage.farthest_deg < 45.0 ? Worth::kAgain : Worth::kUsable,
        formatted("no corner is farther than %.0f degrees from the optical axis, and the "
                  "map uses up to 65: hold the board nearer to the rim",
                  coverage.farthest_deg));
  }
}

void judge(LensCalibration& c) {
  Judgement& j = c.judgement;
  if (c.views.size() < kGoodViews) {
    j.lower(c.views.size() < 7 ? Worth::kAgain : Worth::kUsable,
            formatted("only %zu images were used: take 20 or more", c.views.size()));
  }
  if (c.rms_px > 0.5) {
    j.lower(c.rms_px > 1.2 ? Worth::kAgain : Worth::kUsable,
            formatted("corners are off by %.2f px, expected below 0.5: a flat, stiff board, more "
                      "light, the camera and the board still",
                      c.rms_px));
  }
  judge_coverage(c.coverage, j);
  if (largest_lean_deg(c) < 20.0) {
    j.lower(Worth::kAgain, "all boards face the camera: lean some by 30 degrees, to all sides");
  }
  if (c.centre_sigma_px() > 0.3) {
    j.lower(
        c.centre_sigma_px() > 1.0 ? Worth::kAgain : Worth::kUsable,
        formatted("the centre is known to %.2f px only, expected 0.3: take more views round the "
                  "rim",
                  c.centre_sigma_px()));
  }
  if (c.focal_sigma() > 0.001) {
    j.lower(
        c.focal_sigma() > 0.003 ? Worth::kAgain : Worth::kUsable,
        formatted("the focal length is known to %.2f %% only, expected 0.1: take more views that "
                  "lean, and near ones",
                  100.0 * c.focal_sigma()));
  }
  if (const Status good = check_lens(c.fit.lens); !good) {
    j.lower(Worth::kAgain, "no camera has such a lens: " + good.error().message);
  } else if (const std::string note = lens_note(c.fit.lens); !note.empty()) {
    j.lower(Worth::kUsable, note + ": take views nearer to the rim");
  }
  const std::size_t refused = c.images.size() - c.views.size();
  if (2 * refused > c.images.size()) {
    j.lower(Worth::kUsable, formatted("%zu of %zu images were refused", refused, c.images.size()));
  }
}

}  // namespace

double LensCalibration::centre_sigma_px() const {
  return std::sqrt(std::max(fit.covariance(2, 2), fit.covariance(3, 3)));
}

double LensCalibration::focal_sigma() const {
  return std::max(std::sqrt(fit.covariance(0, 0)) / fit.lens.fu_px,
                  std::sqrt(fit.covariance(1, 1)) / fit.lens.fv_px);
}

std::vector<Eigen::Vector2d> all_corners(const LensCalibration& calibration) {
  std::vector<Eigen::Vector2d> corners;
  for (const BoardView& view : calibration.views) {
    corners.insert(corners.end(), view.seen_px.begin(), view.seen_px.end());
  }
  return corners;
}

Result<LensCalibration> calibrate_lens(const std::vector<SeenBoard>& boards, const Target& target,
                                       int width_px, int height_px) {
  LensCalibration c;
  Selection selection = select(boards, target, c.images);
  drop_planeless(selection, width_px, height_px, c.images);
  auto fit = fit_without_outliers(selection, width_px, height_px, c.images);
  if (!fit) {
    // What was wrong with each image is the help.
    std::string message = fit.error().message;
    for (const ImageReport& image : c.images) {
      if (!image.refused.empty()) message += "\n" + image.name + ": " + image.refused;
    }
    return Error{message};
  }
  c.fit = std::move(*fit);
  c.views = std::move(selection.views);
  std::vector<Eigen::Vector2d> all;
  for (std::size_t i = 0; i < c.views.size(); ++i) {
    const auto some = residuals(c.fit.lens, c.fit.poses[i], c.views[i]);
    all.insert(all.end(), some.begin(), some.end());
  }
  c.rms_px = rms_of(all);
  c.coverage = coverage_of(c.fit.lens, all_corners(c));
  judge(c);
  return c;
}

std::string lens_report(const LensCalibration& c) {
  std::string text;
  for (const ImageReport& image : c.images) {
    text += image.refused.empty() ? formatted("  %s: %zu corners, %.2f px\n", image.name.c_str(),
                                              image.corners, image.rms_px)
                                  : "  " + image.name + ": refused: " + image.refused + "\n";
  }
  const Lens& lens = c.fit.lens;
  const auto sigma = [&c](int i) { return std::sqrt(c.fit.covariance(i, i)); };
  text += formatted("%zu of %zu images used, corners off by %.3f px (root mean square)\n",
                    c.views.size(), c.images.size(), c.rms_px);
  text += formatted("fu %.3f +- %.3f px   fv %.3f +- %.3f px\n", lens.fu_px, sigma(0), lens.fv_px,
                    sigma(1));
  text += formatted("cu %.3f +- %.3f px   cv %.3f +- %.3f px\n", lens.cu_px, sigma(2), lens.cv_px,
                    sigma(3));
  text += formatted("k  %.6f  %.6f  %.6f  %.6f\n", lens.k[0], lens.k[1], lens.k[2], lens.k[3]);
  text += formatted(
      "%d of %d parts of the image covered, farthest corner %.0f degrees from the "
      "axis\n",
      c.coverage.covered, c.coverage.visible, c.coverage.farthest_deg);
  return text + judgement_text(c.judgement);
}

}  // namespace zenith::tools
