#pragma once
// Usenko, Demmel, Cremers, "The double sphere camera model", 3DV 2018, equations 40 to 42.
//
//   z = xi + cos(theta),  d = sqrt(sin^2(theta) + z^2)
//   rho = sin(theta) / (alpha d + (1 - alpha) z)

#include <cmath>

#include "slam/image/lens.h"

namespace zenith::double_sphere {

inline constexpr double kDomain_rad = 3.14;

inline double rho(const Lens& lens, double theta_rad) {
  const double s = std::sin(theta_rad);
  const double z = lens.xi + std::cos(theta_rad);
  return s / (lens.alpha * std::sqrt(s * s + z * z) + (1.0 - lens.alpha) * z);
}

}  // namespace zenith::double_sphere
