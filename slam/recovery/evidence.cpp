#include "slam/recovery/evidence.h"

#include <array>
#include <cmath>
#include <numbers>

#include "slam/fleet/align.h"

namespace zenith {
namespace {

constexpr int kWellInside_px = 24;
constexpr double kWide_px = 10.0;   // for the first fit
constexpr double kNarrow_px = 4.0;  // after it
constexpr float kNccMin = 0.6F;
constexpr float kMaxTurn_rad = 0.6F;
constexpr int kFewObservations = 5;
constexpr int kLeastPairs = 4;

// The horizontal distance that may show a landmark, at a height of 1 m above the camera.
double reach(const FrameOverMap& frame) {
  return std::numbers::sqrt2 * 0.5 * kRectifiedSize * frame.pixel;
}

// Of the free corners within `radius` the most similar one; -1: none is similar.
int find_corner(const FrameOverMap& frame, int slot, const Eigen::Vector2d& m, double heading_rad,
                double radius, std::span<const bool> used) {
  int found = -1;
  float best = kNccMin;
  for (std::size_t k = 0; k < frame.features.size(); ++k) {
    const Feature& f = frame.features[k];
    if (used[k] || !f.described) continue;
    const Eigen::Vector2d d(f.zx - m.x(), f.zy - m.y());
    if (d.squaredNorm() > radius * radius) continue;
    const auto direction =
        static_cast<float>(wrap_angle(heading_rad + static_cast<double>(f.orientation_rad)));
    const float ncc = frame.map.best_ncc(slot, f.patch, direction, kMaxTurn_rad);
    if (ncc <= best) continue;
    best = ncc;
    found = static_cast<int>(k);
  }
  return found;
}

using Pairs = FixedVector<PointPair, kMaxCorners>;

PoseEvidence count(const FrameOverMap& frame, const Pose2& T_own_robot, double radius,
                   Pairs& pairs) {
  PoseEvidence out;
  out.T_own_robot = T_own_robot;
  pairs.clear();
  std::array<bool, kMaxCorners> used = {};
  const Eigen::Vector2d camera = T_own_robot * frame.lever_m;
  const Eigen::Matrix2d to_body = rotation(-T_own_robot.theta_rad);
  const double farthest = reach(frame);
  const auto landmarks = frame.map.landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    const double height = static_cast<double>(l.z_m) - frame.camera_z_m;
    if (!is_reliable(l) || height < 0.1) continue;
    const Eigen::Vector2d d = l.position_m().head<2>() - camera;
    if (d.squaredNorm() > farthest * farthest * height * height) continue;
    const Eigen::Vector2d m = to_body * d / height;
    if (!frame.view.sees(m, kWellInside_px)) continue;
    ++out.expected;
    const int k =
        find_corner(frame, static_cast<int>(slot), m, T_own_robot.theta_rad, radius, used);
    if (k < 0) continue;
    used[static_cast<std::size_t>(k)] = true;
    ++out.hits;
    const Feature& f = frame.features[static_cast<std::size_t>(k)];
    PointPair pair;
    pair.a = l.position_m().head<2>();
    pair.b = frame.lever_m + height * Eigen::Vector2d(f.zx, f.zy);
    const double sigma = radius * height;
    pair.covariance_a *= 0.5 * sigma * sigma;
    pair.covariance_b *= 0.5 * sigma * sigma;
    pairs.push_back(pair);
  }
  return out;
}

}  // namespace

bool is_reliable(const LandmarkInfo& l) {
  return l.state == LandmarkState::kPromoted && l.observations >= kFewObservations &&
         2 * l.observations >= l.chances;
}

PoseEvidence evidence_at(const FrameOverMap& frame, const Pose2& T_own_robot) {
  Pairs pairs;
  Pose2 pose = T_own_robot;
  for (const double radius_px : {kWide_px, kNarrow_px}) {
    count(frame, pose, radius_px * frame.pixel, pairs);
    if (pairs.size() < kLeastPairs) break;
    const AlignmentFit fit = fit_alignment(pairs.span(), pose);
    if (!fit.ok) break;
    pose = fit.T_a_b;
  }
  return count(frame, pose, kNarrow_px * frame.pixel, pairs);
}

}  // namespace zenith
