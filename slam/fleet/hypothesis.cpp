#include "slam/fleet/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slam/bounds.h"
#include "slam/image/ncc.h"

namespace zenith {
namespace {

constexpr double kSameDistance_m = 0.35;
constexpr double kSameTurn_rad = 8.0 * std::numbers::pi / 180.0;
constexpr int kFoundPairs = 4;
// Errors of one map that its landmarks' own covariances do not tell: their drift in common.
constexpr double kMapError_m = 0.01;

double looks_like(std::span<const PeerAppearance> looks, const Observed& own, double heading_rad,
                  double max_turn) {
  double best = -1.0;
  for (const PeerAppearance& a : looks) {
    const double told = static_cast<double>(a.direction_rad - own.orientation_rad);
    if (std::abs(wrap_angle(told - heading_rad)) > max_turn) continue;
    best = std::max(best, static_cast<double>(ncc(a.compact, own.compact)));
  }
  return best;
}

// The peer's landmarks that a frame may show. More than fit: the rest is not looked at.
using NearSlots = FixedVector<std::int32_t, 1024>;

NearSlots landmarks_near(const PeerMap& peer, const Eigen::Vector2d& place, double reach_m) {
  NearSlots near;
  for (int slot = 0; slot < peer.size(); ++slot) {
    const PeerLandmark& l = peer[slot];
    if (!l.present || (l.xy() - place).squaredNorm() > reach_m * reach_m) continue;
    if (!near.push_back(slot)) break;
  }
  return near;
}

double farthest(const ObservedFrame& frame) {
  double square = 0.0;
  for (const Observed& own : frame) square = std::max(square, own.from_robot_m.squaredNorm());
  return std::sqrt(square);
}

}  // namespace

bool same_alignment(const Pose2& a, const Pose2& b, const Eigen::Vector2d& at) {
  const Eigen::Vector2d in_peer = a.inverse() * at;
  return (b * in_peer - at).norm() < kSameDistance_m &&
         std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < kSameTurn_rad;
}

bool confirm_pair(Hypothesis& h, const LandmarkPair& pair) {
  for (std::size_t i = 0; i < h.pairs.size(); ++i) {
    LandmarkPair& p = h.pairs[i];
    const bool own = p.own_slot == pair.own_slot && p.own_id == pair.own_id;
    const bool peer = p.peer_slot == pair.peer_slot && p.peer_id == pair.peer_id;
    if (own && peer) {
      ++p.seen;
      return true;
    }
    if (own || peer) {
      if (--p.seen > 0) return false;
      h.pairs.swap_remove(i);
      break;
    }
  }
  return h.pairs.push_back(pair);
}

FrameTest test_hypothesis(Hypothesis& h, const ObservedFrame& frame, const PeerMap& peer,
                          const Pose2& T_own_robot, const TestSettings& s) {
  FrameTest out;
  const Pose2 T_peer_own = h.T_own_peer.inverse();
  const Pose2 T_peer_robot = T_peer_own * T_own_robot;
  FixedVector<PointPair, kMaxCorners> points;
  const NearSlots near = landmarks_near(peer, T_peer_robot.position(), farthest(frame) + 1.0);
  for (const Observed& own : frame) {
    const Eigen::Vector2d at = T_peer_robot * own.from_robot_m;
    // The alignment is uncertain away from where its pairs lie.
    const Eigen::Matrix<double, 2, 3> J = transform_jacobian(h.T_own_peer, at);
    const double spread = std::sqrt((J * h.covariance * J.transpose()).trace());
    const double radius = s.radius_m + std::min(2.0 * spread, 0.3);
    int best_slot = -1;
    double best = static_cast<double>(s.ncc_min);
    bool any = false;
    for (const std::int32_t slot : near) {
      const PeerLandmark& l = peer[slot];
      const double d2 = (l.xy() - at).squaredNorm();
      if (d2 > 4.0 * radius * radius) continue;
      if (!heights_agree(own, l, s.height_tolerance_m)) continue;
      any = true;
      if (d2 > radius * radius) continue;
      const double look = looks_like(peer.looks(slot), own, T_peer_robot.theta_rad, s.max_turn_rad);
      if (look <= best) continue;
      best = look;
      best_slot = slot;
    }
    out.support.expected += any ? 1 : 0;
    if (best_slot < 0) continue;
    ++out.support.hits;
    confirm_pair(h, {own.slot, own.id, best_slot, peer[best_slot].id, 1});
    PointPair pair;
    pair.a = peer[best_slot].xy();
    pair.b = own.from_robot_m;
    pair.covariance_a *= 0.0016;
    pair.covariance_b *= 0.0016;
    points.push_back(pair);
  }
  if (points.size() >= kFoundPairs) {
    const AlignmentFit fit = fit_alignment(points.span(), T_peer_robot);
    out.found = fit.ok;
    out.T_peer_robot = fit.T_a_b;
  }
  h.evidence.add(out.support);
  return out;
}

void refit(Hypothesis& h, const Map& map, const PeerMap& peer) {
  FixedVector<PointPair, kMaxCorrespondences> points;
  for (std::size_t i = 0; i < h.pairs.size();) {
    const LandmarkPair& p = h.pairs[i];
    const LandmarkInfo& own = map.info(p.own_slot);
    const PeerLandmark& other = peer[p.peer_slot];
    const bool alive = own.state == LandmarkState::kPromoted && own.id == p.own_id &&
                       other.present && other.id == p.peer_id;
    const double off = (h.T_own_peer * other.xy() - own.position_m().head<2>()).norm();
    if (!alive || off > 0.5) {
      h.pairs.swap_remove(i);
      continue;
    }
    PointPair point;
    point.a = own.position_m().head<2>();
    point.b = other.xy();
    const Eigen::Matrix2d error = kMapError_m * kMapError_m * Eigen::Matrix2d::Identity();
    point.covariance_a = own.covariance().topLeftCorner<2, 2>() + error;
    point.covariance_b = other.covariance_xy() + error;
    points.push_back(point);
    ++i;
  }
  const AlignmentFit fit = fit_alignment(points.span(), h.T_own_peer);
  if (!fit.ok || points.size() < 3 || !is_usable(fit.T_a_b)) return;
  h.T_own_peer = fit.T_a_b;
  h.covariance = fit.covariance;
  h.scatter = 0.5 * fit.mean_squared_distance;
}

}  // namespace zenith
