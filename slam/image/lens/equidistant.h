#pragma once
// Kannala, Brandt, "A generic camera model and calibration method for conventional, wide-angle, and
// fish-eye lenses", PAMI 2006, as OpenCV's "fisheye" and Kalibr's "equidistant" have it.
//
//   rho = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)

#include "slam/image/lens.h"

namespace zenith::equidistant {

inline constexpr double kDomain_rad = 3.14;

inline double rho(const Lens& lens, double theta_rad) {
  const auto& k = lens.k;
  const double t2 = theta_rad * theta_rad;
  return theta_rad * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

// d rho / d theta.
inline double slope(const Lens& lens, double theta_rad) {
  const auto& k = lens.k;
  const double t2 = theta_rad * theta_rad;
  return 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
}

}  // namespace zenith::equidistant
