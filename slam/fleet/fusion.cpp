#include "slam/fleet/fusion.h"

#include <algorithm>

#include <Eigen/LU>

namespace zenith {

LandmarkEstimate transform_landmark(const PeerLandmark& l, const Pose2& T_own_peer,
                                    const Eigen::Matrix3d& T_covariance) {
  LandmarkEstimate out;
  const Eigen::Vector2d at = T_own_peer * l.xy();
  out.id = l.id;
  out.position_m = {at.x(), at.y(), static_cast<double>(l.z_m)};
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(T_own_peer.theta_rad);
  const Eigen::Matrix<double, 2, 3> J = transform_jacobian(T_own_peer, l.xy());
  out.covariance_m2 = R * l.covariance() * R.transpose();
  out.covariance_m2.topLeftCorner<2, 2>() += J * T_covariance * J.transpose();
  out.observations = l.observations;
  return out;
}

LandmarkEstimate fuse(const LandmarkEstimate& a, const LandmarkEstimate& b) {
  const Eigen::Matrix3d floor = 1e-8 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d A = (a.covariance_m2 + floor).inverse();
  const Eigen::Matrix3d B = (b.covariance_m2 + floor).inverse();
  LandmarkEstimate out = a;
  out.covariance_m2 = (A + B).inverse();
  out.position_m = out.covariance_m2 * (A * a.position_m + B * b.position_m);
  out.observations = a.observations + b.observations;
  return out;
}

std::size_t read_common_map(const Map& map, const Fleet& fleet, std::span<FusedLandmark> out) {
  std::size_t count = 0;
  for (const LandmarkInfo& l : map.landmarks()) {
    if (count == out.size()) return count;
    if (l.state != LandmarkState::kPromoted) continue;
    out[count++] = {{l.id, l.position_m(), l.covariance(), l.observations}, 1, -1};
  }
  const std::size_t own_count = count;
  for (std::size_t slot = 0; slot < fleet.peers().size(); ++slot) {
    const Peer& peer = fleet.peers()[slot];
    if (!peer.merged) continue;
    const auto pairs = std::span<const Correspondence>(peer.pairs).first(peer.pair_count);
    for (int i = 0; i < peer.map.size(); ++i) {
      const PeerLandmark& l = peer.map[i];
      if (!l.present) continue;
      const LandmarkEstimate theirs =
          transform_landmark(l, peer.alignment.T_own_peer, peer.alignment.covariance);
      const auto pair = std::find_if(pairs.begin(), pairs.end(),
                                     [&l](const Correspondence& c) { return c.peer_id == l.id; });
      if (pair != pairs.end()) {
        const auto end = out.begin() + static_cast<std::ptrdiff_t>(own_count);
        const auto own = std::find_if(out.begin(), end, [pair](const FusedLandmark& f) {
          return f.landmark.id == pair->own_id;
        });
        if (own != end) {
          own->landmark = fuse(own->landmark, theirs);
          ++own->owners;
          continue;
        }
      }
      if (count == out.size()) return count;
      out[count++] = {theirs, 1, static_cast<int>(slot)};
    }
  }
  return count;
}

}  // namespace zenith
