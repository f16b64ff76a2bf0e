#pragma once
// The unified model: a sphere, a pinhole that looks at it from xi behind its centre, and radtan's
// distortion. Mei, Rives, "Single view point omnidirectional camera calibration from planar grids",
// ICRA 2007; camodocal's MEI, Kalibr's omni-radtan, OpenCV's omnidir.
//
//   r = sin(theta) / (cos(theta) + xi),  then as radtan

#include <cmath>

#include "slam/image/lens/radtan.h"

namespace zenith::omni {

inline constexpr double kDomain_rad = 3.14;

// Negative where the ray does not reach the sphere's image.
inline double tangent(const Lens& lens, double theta_rad) {
  return std::sin(theta_rad) / (std::cos(theta_rad) + lens.xi);
}

inline double rho(const Lens& lens, double theta_rad) {
  return radtan::distort(lens, tangent(lens, theta_rad));
}

}  // namespace zenith::omni
