// Sources of the equations: Kalibr's wiki "Supported models"; OpenCV's "Camera Calibration and 3D
// Reconstruction" (radtan, rational); Devernay, Faugeras, "Straight lines have to be straight",
// 2001 (fov); Mei, Rives, ICRA 2007 (omni); Khomutenko et al., RA-L 2016 (eucm); Usenko et al.,
// "The double sphere camera model", 2018 (ds).

#include "tools/calibrate/foreign_models.h"

#include <algorithm>
#include <cmath>

namespace zenith::tools {
namespace {

struct Model {
  const char* name;
  std::size_t intrinsics;
  std::size_t least_distortion;
  std::size_t most_distortion;
};

constexpr Model kModels[] = {
    {"pinhole-equi", 4, 4, 4}, {"pinhole-radtan", 4, 4, 5}, {"pinhole-rational", 4, 8, 14},
    {"pinhole-none", 4, 0, 5}, {"pinhole-fov", 4, 1, 1},    {"omni-radtan", 5, 4, 4},
    {"omni-none", 5, 0, 4},    {"eucm-none", 6, 0, 4},      {"ds-none", 6, 0, 4}};

double at(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? values[i] : 0.0;
}

// Radial and tangential distortion of a pinhole's tangents; none beyond where the radius folds.
std::optional<Eigen::Vector2d> distort(const std::vector<double>& d, const Eigen::Vector2d& m) {
  const auto scaled = [&d](double r2) {
    const double above = 1.0 + r2 * (at(d, 0) + r2 * (at(d, 1) + r2 * at(d, 4)));
    const double below = 1.0 + r2 * (at(d, 5) + r2 * (at(d, 6) + r2 * at(d, 7)));
    return above / below;
  };
  const double r2 = m.squaredNorm();
  // Up to here the distorted radius must rise.
  double before = 0.0;
  constexpr int kSteps = 50;
  for (int i = 1; i <= kSteps; ++i) {
    const double r = std::sqrt(r2) * i / kSteps;
    const double now = r * scaled(r * r);
    if (now < before) return std::nullopt;
    before = now;
  }
  const double p1 = at(d, 2);
  const double p2 = at(d, 3);
  const Eigen::Vector2d tangential(2.0 * p1 * m.x() * m.y() + p2 * (r2 + 2.0 * m.x() * m.x()),
                                   p1 * (r2 + 2.0 * m.y() * m.y()) + 2.0 * p2 * m.x() * m.y());
  return Eigen::Vector2d(scaled(r2) * m + tangential);
}

std::optional<Eigen::Vector2d> normalised(const ForeignLens& lens, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d p = ray.normalized();
  const auto& d = lens.distortion;
  const auto& in = lens.intrinsics;
  if (lens.model == "pinhole-equi") {
    Lens equal;
    std::copy_n(d.begin(), 4, equal.k.begin());
    const double r = p.head<2>().norm();
    const double scale = r < 1e-12 ? 1.0 : equal.distort(std::atan2(r, p.z())) / r;
    return Eigen::Vector2d(scale * p.head<2>());
  }
  if (lens.model.starts_with("omni")) {
    const double z = p.z() + in[0];
    if (z < 0.05) return std::nullopt;
    return distort(d, p.head<2>() / z);
  }
  if (lens.model == "eucm-none") {
    const double alpha = in[0];
    const double rho = std::sqrt(in[1] * p.head<2>().squaredNorm() + p.z() * p.z());
    const double below = alpha * rho + (1.0 - alpha) * p.z();
    if (below < 0.05) return std::nullopt;
    return Eigen::Vector2d(p.head<2>() / below);
  }
  if (lens.model == "ds-none") {
    const double xi = in[0];
    const double alpha = in[1];
    const double z = xi + p.z();  // the first distance is 1
    const double d2 = std::sqrt(p.head<2>().squaredNorm() + z * z);
    const double below = alpha * d2 + (1.0 - alpha) * z;
    if (below < 0.05) return std::nullopt;
    return Eigen::Vector2d(p.head<2>() / below);
  }
  if (p.z() < 0.05) return std::nullopt;
  const Eigen::Vector2d m = p.head<2>() / p.z();
  if (lens.model == "pinhole-none") return m;
  if (lens.model == "pinhole-fov") {
    const double w = d[0];
    const double r = m.norm();
    if (r < 1e-9 || w < 1e-9) return m;
    return Eigen::Vector2d(std::atan(2.0 * r * std::tan(0.5 * w)) / w / r * m);
  }
  return distort(d, m);
}

}  // namespace

Status check_model(const ForeignLens& lens) {
  std::string known;
  for (const Model& model : kModels) {
    known += (known.empty() ? "" : ", ") + std::string(model.name);
    if (lens.model != model.name) continue;
    if (lens.intrinsics.size() != model.intrinsics) {
      return Error{lens.model + ": expected " + std::to_string(model.intrinsics) +
                   " intrinsics, found " + std::to_string(lens.intrinsics.size())};
    }
    if (lens.distortion.size() < model.least_distortion ||
        lens.distortion.size() > model.most_distortion) {
      return Error{lens.model + ": expected " + std::to_string(model.least_distortion) + " to " +
                   std::to_string(model.most_distortion) + " distortion coefficients, found " +
                   std::to_string(lens.distortion.size())};
    }
    return {};
  }
  return Error{"expected a lens of one of the models " + known + "; found '" + lens.model +
               "'; calibrate with `zenith calibrate lens`"};
}

std::optional<Eigen::Vector2d> project_foreign(const ForeignLens& lens,
                                               const Eigen::Vector3d& ray) {
  const auto m = normalised(lens, ray);
  if (!m) return std::nullopt;
  const auto f = lens.intrinsics.end() - 4;
  return Eigen::Vector2d(f[0] * m->x() + f[2], f[1] * m->y() + f[3]);
}

}  // namespace zenith::tools
