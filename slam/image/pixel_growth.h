#pragma once
// How a pixel of the frame grows in tangents from the optical axis outwards, r = tan(theta):
//
//   along the radius  (dr / drho) = (1 + r^2) / rho'(theta),   across it  r / rho(theta)
//
// each by its value on the axis. An equidistant lens has 1 + r^2 and r / atan(r), a pinhole 1 and
// 1; others are taken as powers of 1 + r^2 through their growth at the edge of the view, which is
// near enough for a variance and a derivative. Symbols as in slam/image/lens.h.

#include <cmath>

#include "slam/image/lens_projection.h"

namespace zenith {

struct PixelGrowth {
  bool equidistant = true;
  double along_power = 1.0;  // of the others
  double across_power = 0.5;

  double along(double r) const {
    return equidistant ? 1.0 + r * r : std::pow(1.0 + r * r, along_power);
  }
  double across(double r) const {
    if (!equidistant) return std::pow(1.0 + r * r, across_power);
    return r < 1e-6 ? 1.0 : r / std::atan(r);
  }
  // The variance on the axis, grown: one for both axes, the geometric mean.
  float grown(float variance, float r2) const {
    if (equidistant) return variance * (1.0F + r2) * std::sqrt(1.0F + r2);
    return variance * std::exp(static_cast<float>(along_power + across_power) * std::log1p(r2));
  }
};

// Within a field of view of the rectified image.
PixelGrowth pixel_growth(const LensProjection& projection, double fov_deg);

}  // namespace zenith
