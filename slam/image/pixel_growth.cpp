#include "slam/image/pixel_growth.h"

#include <algorithm>
#include <numbers>

namespace zenith {

PixelGrowth pixel_growth(const LensProjection& projection, double fov_deg) {
  PixelGrowth growth;
  if (projection.lens().model == LensModel::kEquidistant) return growth;
  // Before a fold, where the slope is zero.
  constexpr double kOfLimit = 0.9;
  constexpr double kMostPower = 3.0;
  constexpr double kStep_rad = 1e-4;
  const double theta =
      std::min(0.5 * fov_deg * std::numbers::pi / 180.0, kOfLimit * projection.limit_rad());
  const double r = std::tan(theta);
  const double slope = (projection.rho(theta + kStep_rad) - projection.rho(theta - kStep_rad)) /
                       (2.0 * kStep_rad * projection.axis_slope());
  const double rho = projection.rho(theta) / projection.axis_slope();
  const double along = std::log((1.0 + r * r) / slope) / std::log1p(r * r);
  const double across = std::log(r / rho) / std::log1p(r * r);
  if (!std::isfinite(along) || !std::isfinite(across)) return growth;
  growth.equidistant = false;
  growth.along_power = std::clamp(along, -kMostPower, kMostPower);
  growth.across_power = std::clamp(across, -kMostPower, kMostPower);
  return growth;
}

}  // namespace zenith
