#pragma once
// A pinhole's tangents with radial and decentring distortion. Brown, "Decentering distortion of
// lenses", 1966; OpenCV, "Camera calibration and 3D reconstruction": its 4 or 5 coefficients (ROS's
// plumb_bob) leave k4, k5, k6 zero, its 8 (rational_polynomial) do not.
//
//   x = r e, r = tan(theta), q = (p2, p1)
//   m = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + r^2 q + 2 (q x) x

#include <cmath>

#include <Eigen/Core>

#include "slam/image/lens.h"

namespace zenith::radtan {

inline constexpr double kDomain_rad = 1.55;  // tangents end at 90 degrees

// Of the tangent r. Coefficients that the model has not are zero.
inline double distort(const Lens& lens, double r) {
  const auto& k = lens.k;
  const double r2 = r * r;
  const double above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
  const double below = 1.0 + r2 * (k[3] + r2 * (k[4] + r2 * k[5]));
  return r * above / below;
}

inline double rho(const Lens& lens, double theta_rad) {
  return distort(lens, std::tan(theta_rad));
}

inline Eigen::Vector2d decentring(const Lens& lens, const Eigen::Vector2d& x) {
  const Eigen::Vector2d q(lens.p[1], lens.p[0]);
  return x.squaredNorm() * q + 2.0 * q.dot(x) * x;
}

// What of rho the decentring takes on its worst side. While rho minus this rises with r, the
// derivative of m by x is symmetric and positive definite, and no two rays share a pixel.
inline double decentring_loss(const Lens& lens, double r) {
  return 3.0 * std::hypot(lens.p[0], lens.p[1]) * r * r;
}

}  // namespace zenith::radtan
