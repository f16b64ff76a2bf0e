#include "slam/observed.h"

#include <cmath>

namespace zenith {

void observe(const Mapper& mapper, const Features& features, ObservedFrame& out) {
  out.clear();
  const double camera_z = mapper.robot().mount.z_m;
  for (const Candidate& c : mapper.candidates()) {
    if (!c.inlier) continue;
    const LandmarkInfo& l = mapper.map().info(c.slot);
    if (l.state != LandmarkState::kPromoted) continue;
    const Feature& f = features[static_cast<std::size_t>(c.corner)];
    Observed o;
    o.slot = c.slot;
    o.id = l.id;
    o.z_m = static_cast<double>(l.z_m);
    o.z_sigma_m = std::sqrt(static_cast<double>(l.covariance_m2[5]));
    o.from_robot_m = mapper.lever_m() + (o.z_m - camera_z) * Eigen::Vector2d(f.zx, f.zy);
    o.orientation_rad = f.orientation_rad;
    o.compact = f.compact;
    out.push_back(o);
  }
}

}  // namespace zenith
