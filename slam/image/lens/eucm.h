#pragma once
// The enhanced unified camera model: Khomutenko, Garcia, Martinet, "An enhanced unified camera
// model", RA-L 2016.
//
//   rho = sin(theta) / (alpha sqrt(beta sin^2(theta) + cos^2(theta)) + (1 - alpha) cos(theta))

#include <cmath>

#include "slam/image/lens.h"

namespace zenith::eucm {

inline constexpr double kDomain_rad = 3.14;

inline double rho(const Lens& lens, double theta_rad) {
  const double s = std::sin(theta_rad);
  const double z = std::cos(theta_rad);
  return s / (lens.alpha * std::sqrt(lens.beta * s * s + z * z) + (1.0 - lens.alpha) * z);
}

}  // namespace zenith::eucm
