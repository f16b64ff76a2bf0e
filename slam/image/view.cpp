#include "slam/image/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/image/rectify.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLeastShare = 0.5;
constexpr int kRings = 64;  // squares round the middle

double half_side(double fov_deg) {
  return std::tan(0.5 * fov_deg * kDegree);
}

double fov_of(double half) {
  return 2.0 * std::atan(half) / kDegree;
}

// Half the side of the square round the vertical, in tangents, that holds all of the lens's image;
// `most` at most.
double whole_image(const LensProjection& projection, const Eigen::Matrix3d& R_base_camera,
                   double most) {
  constexpr int kSteps = 48;
  double half = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d uv(i * (projection.lens().width_px - 1.0) / kSteps,
                               j * (projection.lens().height_px - 1.0) / kSteps);
      const auto in_camera = projection.unproject(uv);
      if (!in_camera) continue;
      const Eigen::Vector3d ray = R_base_camera * *in_camera;
      const double across = std::max(std::abs(ray.x()), std::abs(ray.y()));
      half = std::max(half, across < most * ray.z() ? across / ray.z() : most);
    }
  }
  return half;
}

// Of the squares with half sides half / kRings, 2 half / kRings, .. half: which share of each lies
// in the lens's image.
std::array<double, kRings> shares(const LensProjection& projection,
                                  const Eigen::Matrix3d& R_base_camera, double half) {
  std::array<int, kRings> inside = {};
  const Eigen::Matrix3d R_camera_base = R_base_camera.transpose();
  for (int i = -kRings; i < kRings; ++i) {
    for (int j = -kRings; j < kRings; ++j) {
      const Eigen::Vector3d ray((i + 0.5) * half / kRings, (j + 0.5) * half / kRings, 1.0);
      const auto uv = projection.project(R_camera_base * ray);
      if (!uv || !projection.in_image(*uv)) continue;
      const int ring = std::max(i < 0 ? -i - 1 : i, j < 0 ? -j - 1 : j);
      ++inside[static_cast<std::size_t>(ring)];
    }
  }
  std::array<double, kRings> share = {};
  int sum = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    sum += inside[static_cast<std::size_t>(ring)];
    share[static_cast<std::size_t>(ring)] = sum / (4.0 * (ring + 1) * (ring + 1));
  }
  return share;
}

double inside_share(const LensProjection& projection, const Eigen::Matrix3d& R, double fov_deg) {
  return shares(projection, R, half_side(fov_deg)).back();
}

}  // namespace

View fitted_view(const LensProjection& projection, const CameraMount& mount) {
  const Eigen::Matrix3d R = mount_rotation(mount);
  const double most = half_side(kWidestFitted_deg);
  const double whole = whole_image(projection, R, most);
  const auto share = shares(projection, R, whole);
  int best = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const auto at = [&](int i) {
      return std::min(kLeastShare, share[static_cast<std::size_t>(i)]);
    };
    if (at(ring) >= at(best)) best = ring;
  }
  const double half = whole * (best + 1) / kRings;
  // Rounded, the number that is told is the number that is used.
  const double fov_deg = std::ceil(10.0 * fov_of(half) - 1e-6) / 10.0;
  View view;
  view.fov_deg = std::clamp(fov_deg, kNarrowestFitted_deg, kWidestFitted_deg);
  view.inside_share = inside_share(projection, R, view.fov_deg);
  return view;
}

View view_of(const Parameters& parameters, const RobotConfig& robot) {
  const LensProjection projection(robot.lens);
  if (parameters.rectified_fov_deg == kFittedView) return fitted_view(projection, robot.mount);
  return {parameters.rectified_fov_deg,
          inside_share(projection, mount_rotation(robot.mount), parameters.rectified_fov_deg)};
}

Parameters with_fitted_view(const Parameters& parameters, const RobotConfig& robot) {
  Parameters out = parameters;
  if (out.rectified_fov_deg == kFittedView) out.rectified_fov_deg = view_of(out, robot).fov_deg;
  return out;
}

}  // namespace zenith
