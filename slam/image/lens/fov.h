#pragma once
// Devernay, Faugeras, "Straight lines have to be straight", MVA 2001. Written with atan2, which
// goes on beyond 90 degrees from the axis.
//
//   rho = atan(2 tan(theta) tan(w / 2)) / w

#include <cmath>

#include "slam/image/lens.h"

namespace zenith::fov {

inline constexpr double kDomain_rad = 3.14;

inline double rho(const Lens& lens, double theta_rad) {
  return std::atan2(2.0 * std::tan(0.5 * lens.w) * std::sin(theta_rad), std::cos(theta_rad)) /
         lens.w;
}

}  // namespace zenith::fov
