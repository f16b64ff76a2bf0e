#include "tools/calibrate/lens_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/image/lens_projection.h"
#include "tools/doctor/formatted.h"
#include "tools/report/canvas.h"

namespace zenith::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMargin_px = 40.0;
constexpr double kTitle_px = 96.0;
constexpr double kImageWidth_px = 920.0;
constexpr Colour kMissing{214, 20, 160};
constexpr Colour kDot{0, 114, 178};
constexpr Colour kCurve{213, 94, 0};

// The camera's image on the page.
struct ImageFrame {
  double scale = 1.0;
  const Lens& lens;
  LensProjection projection;

  explicit ImageFrame(const Lens& l) : scale(kImageWidth_px / l.width_px), lens(l), projection(l) {}
  double height() const { return scale * lens.height_px; }
  Eigen::Vector2d at(const Eigen::Vector2d& uv) const {
    return {kMargin_px + scale * (uv.x() + 0.5), kTitle_px + scale * (uv.y() + 0.5)};
  }
  bool holds(const Eigen::Vector2d& uv) const {
    return uv.x() >= -0.5 && uv.y() >= -0.5 && uv.x() < lens.width_px && uv.y() < lens.height_px;
  }
  // Outside of the image where the lens shows no such direction.
  Eigen::Vector2d direction(double theta, double azimuth) const {
    return projection
        .project({std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                  std::cos(theta)})
        .value_or(Eigen::Vector2d(-1e6, -1e6));
  }
};

void draw_border(Canvas& canvas, const ImageFrame& frame) {
  const double w = frame.lens.width_px - 1.0;
  const double h = frame.lens.height_px - 1.0;
  canvas.path(
      {frame.at({0, 0}), frame.at({w, 0}), frame.at({w, h}), frame.at({0, h}), frame.at({0, 0})},
      kInk, 1.2);
}

void draw_ring(Canvas& canvas, const ImageFrame& frame, double theta, Colour colour) {
  constexpr int kSteps = 120;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector2d a = frame.direction(theta, 2.0 * kPi * i / kSteps);
    const Eigen::Vector2d b = frame.direction(theta, 2.0 * kPi * (i + 1) / kSteps);
    if (frame.holds(a) && frame.holds(b)) canvas.line(frame.at(a), frame.at(b), colour, 1.2);
  }
}

void draw_rings(Canvas& canvas, const ImageFrame& frame) {
  for (int ring = 1; ring <= kRings; ++ring) {
    const double theta = kRingEdges_deg[ring] * kPi / 180.0;
    draw_ring(canvas, frame, theta, kGrey);
    const Eigen::Vector2d at = frame.direction(theta, -0.38 * kPi);
    if (!frame.holds(at)) continue;
    canvas.text(frame.at(at) + Eigen::Vector2d(4.0, -4.0),
                formatted("%.0f deg", kRingEdges_deg[ring]), 10.0, kGrey);
  }
}

void draw_missing(Canvas& canvas, const ImageFrame& frame, int ring, int sector) {
  const double in = (kRingEdges_deg[ring] + 1.5) * kPi / 180.0;
  const double out = (kRingEdges_deg[ring + 1] - 1.5) * kPi / 180.0;
  const double half = kPi / kSectors - 0.03;
  const double middle = 2.0 * kPi * sector / kSectors;
  constexpr int kSteps = 8;
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i <= kSteps; ++i) {
    outline.push_back(frame.direction(out, middle - half + 2.0 * half * i / kSteps));
  }
  for (int i = kSteps; i >= 0; --i) {
    outline.push_back(frame.direction(in, middle - half + 2.0 * half * i / kSteps));
  }
  outline.push_back(outline.front());
  std::vector<Eigen::Vector2d> inside;
  for (const auto& uv : outline) {
    if (frame.holds(uv)) inside.push_back(frame.at(uv));
  }
  canvas.path(inside, kMissing, 3.0);
  const Eigen::Vector2d centre = frame.direction(0.5 * (in + out), middle);
  if (frame.holds(centre)) {
    canvas.text(frame.at(centre), "more", 11.0, kMissing, Anchor::kCentre, true);
  }
}

// Residuals by the angle from the axis: a lens model that does not fit shows as a wave.
void draw_radial(Canvas& canvas, const LensCalibration& c, double top, double height) {
  const double left = kMargin_px + 40.0;
  const double width = kImageWidth_px - 40.0;
  const double limit = std::max(0.5, 4.0 * c.rms_px);
  const auto at = [&](double theta_deg, double off) {
    return Eigen::Vector2d(left + width * theta_deg / 95.0,
                           top + 0.5 * height * (1.0 - std::clamp(off / limit, -1.0, 1.0)));
  };
  canvas.line(at(0, 0), at(95, 0), kGrey, 1.0);
  for (const double off : {-limit, limit}) canvas.line(at(0, off), at(95, off), kPale, 1.0);
  canvas.text(at(0, limit) + Eigen::Vector2d(-6, 5), formatted("%.1f px", limit), 10.0, kInk,
              Anchor::kRight);
  canvas.text(at(0, -limit) + Eigen::Vector2d(-6, 5), formatted("-%.1f", limit), 10.0, kInk,
              Anchor::kRight);
  for (int deg = 0; deg <= 90; deg += 15) {
    canvas.text(at(deg, -limit) + Eigen::Vector2d(0, 24), std::to_string(deg), 10.0, kInk,
                Anchor::kCentre);
  }
  canvas.text({left + 0.5 * width, top + height + 48.0},
              "degrees from the optical axis; error along the radius", 11.0, kInk, Anchor::kCentre);
  const LensProjection projection(c.fit.lens);
  std::array<double, 19> sum = {};
  std::array<int, 19> count = {};
  for (std::size_t i = 0; i < c.views.size(); ++i) {
    const auto off = residuals(c.fit.lens, c.fit.poses[i], c.views[i]);
    for (std::size_t k = 0; k < off.size(); ++k) {
      const auto seen = projection.unproject(c.views[i].seen_px[k]);
      if (!seen) continue;
      const Eigen::Vector3d& ray = *seen;
      const double theta = std::atan2(ray.head<2>().norm(), ray.z()) * 180.0 / kPi;
      const double radial = off[k].dot(ray.head<2>().normalized());
      canvas.disc(at(theta, radial), 1.4, kDot);
      const auto bin = static_cast<std::size_t>(std::min(18.0, theta / 5.0));
      sum[bin] += radial;
      ++count[bin];
    }
  }
  std::vector<Eigen::Vector2d> means;
  for (std::size_t bin = 0; bin < sum.size(); ++bin) {
    if (count[bin] < 5) continue;
    means.push_back(at(5.0 * static_cast<double>(bin) + 2.5, sum[bin] / count[bin]));
  }
  if (means.size() > 1) canvas.path(means, kCurve, 2.5);
}

}  // namespace

Status draw_coverage(const LensCalibration& c, const std::filesystem::path& path) {
  const ImageFrame frame(c.fit.lens);
  Canvas canvas(static_cast<int>(kImageWidth_px + 2.0 * kMargin_px),
                static_cast<int>(frame.height() + kTitle_px + kMargin_px));
  canvas.text({kMargin_px, 44.0}, "Where the board's corners were seen", 20.0, kInk, Anchor::kLeft,
              true);
  canvas.text(
      {kMargin_px, 72.0},
      formatted("%zu images used; %d of %d parts covered; hold the board where it says more",
                c.views.size(), c.coverage.covered, c.coverage.visible),
      12.0, kInk);
  draw_rings(canvas, frame);
  for (const auto& uv : all_corners(c)) canvas.disc(frame.at(uv), 1.8, kDot);
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      const CoverageCell& cell =
          c.coverage.cells[static_cast<std::size_t>(ring)][static_cast<std::size_t>(sector)];
      if (cell.visible && !cell.enough()) draw_missing(canvas, frame, ring, sector);
    }
  }
  draw_border(canvas, frame);
  return canvas.save(path);
}

Status draw_residuals(const LensCalibration& c, const std::filesystem::path& path) {
  constexpr double kRadial_px = 220.0;
  const ImageFrame frame(c.fit.lens);
  Canvas canvas(static_cast<int>(kImageWidth_px + 2.0 * kMargin_px),
                static_cast<int>(frame.height() + kTitle_px + kRadial_px + 140.0));
  const double magnify = std::clamp(8.0 / std::max(0.02, c.rms_px), 5.0, 200.0);
  canvas.text({kMargin_px, 44.0}, "By how much the corners are missed", 20.0, kInk, Anchor::kLeft,
              true);
  canvas.text({kMargin_px, 72.0},
              formatted("%.3f px root mean square; lines are %.0f times as long as the errors",
                        c.rms_px, magnify),
              12.0, kInk);
  draw_rings(canvas, frame);
  for (std::size_t i = 0; i < c.views.size(); ++i) {
    const auto off = residuals(c.fit.lens, c.fit.poses[i], c.views[i]);
    for (std::size_t k = 0; k < off.size(); ++k) {
      const Eigen::Vector2d from = frame.at(c.views[i].seen_px[k]);
      canvas.line(from, from + magnify * off[k], kDot, 1.0);
    }
  }
  draw_border(canvas, frame);
  draw_radial(canvas, c, kTitle_px + frame.height() + 40.0, kRadial_px);
  return canvas.save(path);
}

}  // namespace zenith::tools
