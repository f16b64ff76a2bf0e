#include "slam/recovery/pose_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/kernels/match/match.h"

namespace zenith {
namespace {

constexpr float kNccMin = 0.75F;
constexpr double kPeriphery = 0.3;  // an angle between patches' directions is good to 20 degrees

// The most similar look of one landmark for every corner.
struct LookFor {
  std::array<float, kMaxCorners> ncc;
  std::array<float, kMaxCorners> direction_rad;
  FixedVector<std::int16_t, kMaxCorners> corners;

  void clear() {
    for (const std::int16_t k : corners) ncc[static_cast<std::size_t>(k)] = 0.0F;
    corners.clear();
  }
  void add(int corner, float found, float direction) {
    const auto k = static_cast<std::size_t>(corner);
    if (ncc[k] == 0.0F) corners.push_back(static_cast<std::int16_t>(corner));
    if (found <= ncc[k]) return;
    ncc[k] = found;
    direction_rad[k] = direction;
  }
};

}  // namespace

void PoseSearch::layout(Arena& arena) {
  hough_.layout(arena);
  matches_ = arena.take<OverlapMatches>(1);
  fixes_ = arena.take<PlaceFixes>(1);
  best_ = arena.take<BestMatches>(kMaxCorners);
}

void PoseSearch::find_matches(const FrameOverMap& frame, const SearchArea& area) {
  const MatchKernels<kCompactLength>& match = match_in_use().compact;
  MatchQueries<kCompactLength> queries;
  std::array<std::int16_t, kMaxCorners> corner_of;  // by query
  for (std::size_t k = 0; k < frame.features.size(); ++k) {
    best_[k].clear();
    const Feature& f = frame.features[k];
    if (!f.described) continue;
    corner_of[static_cast<std::size_t>(queries.count)] = static_cast<std::int16_t>(k);
    match.pack(queries, f.compact.values.data(), f.compact.inverse_norm);
  }
  const double reach_m = std::numbers::sqrt2 * 0.5 * kRectifiedSize * frame.pixel;
  std::array<LookFound, kMaxCorners> found;
  LookFor look;
  look.ncc.fill(0.0F);
  const auto landmarks = frame.map.landmarks();
  for (std::size_t slot = 0; slot < landmarks.size(); ++slot) {
    const LandmarkInfo& l = landmarks[slot];
    const double height = static_cast<double>(l.z_m) - frame.camera_z_m;
    if (!is_reliable(l) || height < 0.1) continue;
    const Eigen::Vector2d landmark_m = l.position_m().head<2>();
    if ((landmark_m - area.around.position()).norm() > area.radius_m + reach_m * height) continue;
    look.clear();
    for (int i = l.first_appearance; i >= 0; i = frame.map.appearance(i).next) {
      const Appearance& a = frame.map.appearance(i);
      const Looks one = {a.compact.values.data(), &a.compact.inverse_norm, sizeof(Appearance), 1};
      const int count = match.best_of(queries, one, kNccMin, found.data());
      for (int n = 0; n < count; ++n) {
        const LookFound& hit = found[static_cast<std::size_t>(n)];
        look.add(corner_of[static_cast<std::size_t>(hit.query)], hit.ncc, a.direction_rad);
      }
    }
    for (const std::int16_t corner : look.corners) {
      const auto k = static_cast<std::size_t>(corner);
      const Feature& f = frame.features[k];
      const double heading =
          wrap_angle(static_cast<double>(look.direction_rad[k] - f.orientation_rad));
      const double turn = std::abs(wrap_angle(heading - area.around.theta_rad));
      if (turn > area.turn_rad + kPeriphery) continue;
      best_[k].meet({static_cast<int>(slot), look.ncc[k], heading});
    }
  }
}

void PoseSearch::find(const FrameOverMap& frame, const SearchArea& area, Poses& out) {
  out.clear();
  find_matches(frame, area);
  OverlapMatches& matches = matches_[0];
  matches.clear();
  for (std::size_t k = 0; k < frame.features.size(); ++k) {
    best_[k].append_to(static_cast<int>(k), matches);
  }
  for (OverlapMatch& m : matches) {
    const Feature& f = frame.features[static_cast<std::size_t>(m.observed)];
    const Eigen::Vector3d landmark = frame.map.info(m.peer_slot).position_m();
    const double height = landmark.z() - frame.camera_z_m;
    m.from_robot_m = frame.lever_m + height * Eigen::Vector2d(f.zx, f.zy);
    m.landmark_m = landmark.head<2>();
  }
  hough_.find_places(matches, {}, fixes_[0]);
  for (const PlaceFix& fix : fixes_[0]) {
    const PoseEvidence evidence = evidence_at(frame, fix.T_peer_robot);
    const Pose2 off = area.around.inverse() * evidence.T_own_robot;
    if (off.position().norm() > area.radius_m || std::abs(off.theta_rad) > area.turn_rad) continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const PoseEvidence& other) {
      const Pose2 apart = other.T_own_robot.inverse() * evidence.T_own_robot;
      return apart.position().norm() < 0.15 && std::abs(apart.theta_rad) < 0.1;
    });
    if (!known) out.push_back(evidence);
  }
  std::sort(out.begin(), out.end(),
            [](const PoseEvidence& a, const PoseEvidence& b) { return a.hits > b.hits; });
}

}  // namespace zenith
