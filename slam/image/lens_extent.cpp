#include "slam/image/lens_extent.h"

#include <algorithm>
#include <cmath>

namespace zenith {

LensExtent lens_extent(const LensProjection& projection) {
  constexpr int kSteps = 32;  // along each side
  LensExtent extent;
  extent.whole = true;
  const double right = projection.lens().width_px - 1;
  const double bottom = projection.lens().height_px - 1;
  const auto look = [&](double u, double v) {
    const auto ray = projection.unproject({u, v});
    extent.whole = extent.whole && ray;
    const double theta = ray ? std::atan2(ray->head<2>().norm(), ray->z()) : projection.limit_rad();
    extent.widest_rad = std::max(extent.widest_rad, theta);
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    look(share * right, 0.0);
    look(share * right, bottom);
    look(0.0, share * bottom);
    look(right, share * bottom);
  }
  return extent;
}

}  // namespace zenith
