#include "tools/calibrate/import.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "platform/config/robot_settings.h"
#include "tools/calibrate/foreign_models.h"
#include "tools/calibrate/projection.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMost_px = 1.0;  // error of a fitted lens, anywhere

struct Seen {
  Eigen::Vector3d ray;
  Eigen::Vector2d uv;
};

// Rays all over the image, as the foreign lens shows them.
std::vector<Seen> sample_rays(const ForeignLens& foreign) {
  std::vector<Seen> seen;
  for (int ring = 0; ring < 60; ++ring) {
    const double theta = (ring + 0.5) * 1.75 / 60.0;
    for (int step = 0; step < 48; ++step) {
      const double azimuth = 2.0 * std::numbers::pi * step / 48.0;
      const Eigen::Vector3d ray(std::sin(theta) * std::cos(azimuth),
                                std::sin(theta) * std::sin(azimuth), std::cos(theta));
      const auto uv = project_foreign(foreign, ray);
      if (!uv || uv->x() < 0.0 || uv->y() < 0.0 || uv->x() > foreign.width_px - 1 ||
          uv->y() > foreign.height_px - 1) {
        continue;
      }
      seen.push_back({ray, *uv});
    }
  }
  return seen;
}

// Gauss and Newton's method; the model is nearly linear in its numbers.
Lens fitted(const std::vector<Seen>& seen, Lens lens) {
  for (int i = 0; i < 30; ++i) {
    LensMatrix H = LensMatrix::Identity() * 1e-9;
    LensVector g = LensVector::Zero();
    for (const Seen& s : seen) {
      const Projection p = project_with_derivatives(lens, s.ray);
      H += p.by_lens.transpose() * p.by_lens;
      g += p.by_lens.transpose() * (s.uv - p.uv_px);
    }
    const LensVector step = H.ldlt().solve(g);
    lens = lens_of_vector(lens_vector(lens) + step, lens.width_px, lens.height_px);
    if (step.norm() < 1e-10) break;
  }
  return lens;
}

}  // namespace

Result<ImportedLens> import_lens(const ForeignLens& foreign) {
  if (const Status known = check_model(foreign); !known) return known.error();
  if (foreign.width_px < 16 || foreign.height_px < 16) {
    return Error{"expected the size of the image, found none"};
  }
  const auto f = foreign.intrinsics.end() - 4;
  ImportedLens out;
  out.lens = {foreign.width_px, foreign.height_px, f[0], f[1], f[2], f[3], {}};
  const std::vector<Seen> seen = sample_rays(foreign);
  if (seen.size() < 100) return Error{"the lens shows nothing in its image: its numbers are wrong"};
  for (const Seen& s : seen) {
    out.widest_deg =
        std::max(out.widest_deg, std::atan2(s.ray.head<2>().norm(), s.ray.z()) * kDegPerRad);
  }
  if (foreign.model == "pinhole-equi") {
    std::copy_n(foreign.distortion.begin(), 4, out.lens.k.begin());
  } else {
    out.exact = false;
    out.lens = fitted(seen, out.lens);
    double sum = 0.0;
    for (const Seen& s : seen) {
      const double off = (out.lens.project(s.ray) - s.uv).norm();
      sum += off * off;
      out.worst_px = std::max(out.worst_px, off);
    }
    out.rms_px = std::sqrt(sum / static_cast<double>(seen.size()));
    if (!(out.worst_px <= kMost_px)) {
      return Error{
          formatted("no equidistant lens comes nearer than %.1f px to this one (%s), "
                    "expected 1 px: calibrate with `zenith calibrate lens`",
                    out.worst_px, foreign.model.c_str())};
    }
  }
  if (foreign.model == "pinhole-equi" && folds(out.lens)) {
    return Error{
        "the lens's curve folds back within 75 degrees of the axis: its views did not "
        "reach the rim; calibrate with `zenith calibrate lens`"};
  }
  return out;
}

}  // namespace zenith::tools
