#pragma once
// Which corner is which landmark (paper III-A): predicted position, gate, NCC over the looks; then
// one robust correction of the pose that all matches must agree with.
//
// Coordinates are tangents in the level image throughout.

#include <span>

#include <Eigen/Core>

#include "platform/base/fixed_vector.h"
#include "slam/capacity.h"
#include "slam/image/feature.h"
#include "slam/map/map.h"

namespace zenith {

// A landmark predicted into the image, averaged over the particles.
struct Candidate {
  int slot = -1;
  bool promoted = false;     // or as good as: it may steer
  bool old = false;          // not seen for a long way: perhaps the loop closes
  bool well_inside = false;  // a detector should find it
  Eigen::Vector2d m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d own = Eigen::Matrix2d::Zero();     // S: landmark and measurement noise
  Eigen::Matrix2d common = Eigen::Matrix2d::Zero();  // spread of the particles, odometry, drift
  Eigen::Matrix<double, 2, 3> G = Eigen::Matrix<double, 2, 3>::Zero();  // by (forward, left, turn)
  // The common error of the anchor's landmarks (slam/filter/depth_prior.h); 0: settled.
  int anchor = -1;
  double rho = 0.0;  // with which G is made
  double rho_variance = 0.0;
  double shared = 0.0;
  Eigen::Vector2d u = Eigen::Vector2d::Zero();
  // From the matched corner to the landmark's look in its patch (patch_shift.h): in the patch's
  // axes, and in tangents.
  Eigen::Vector2f shift_px = Eigen::Vector2f::Zero();
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  int corner = -1;  // the match
  float ncc = 0.0F;
  bool inlier = false;
  double misfit = 0.0;  // of an inlier: squared distance from its prediction, per axis, in sigmas
  float noise = 0.0F;   // of an inlier: variance on each axis with which it counts
  float stated_noise = 0.0F;  // the part of `own` that is measurement noise
  Eigen::Matrix2d own_trusted() const {
    return own + static_cast<double>(noise - stated_noise) * Eigen::Matrix2d::Identity();
  }
};

using Candidates = FixedVector<Candidate, kMaxCandidates>;

// Where a matched landmark is seen, in tangents.
inline Eigen::Vector2f seen_at(const Candidate& c, const Feature& f) {
  return Eigen::Vector2f(f.zx, f.zy) + c.shift;
}

struct AssociationSettings {
  double gate_sigma = 3.5;
  double max_radius = 0.25;  // tangents; beyond, the ceiling repeats itself
  double min_radius = 0.015;
  float ncc_min = 0.65F;
  float max_turn_rad = 0.6F;
};

// Gives each candidate of the wanted kind the best free corner within its gate, where the gate is
// centred at m + G xi with covariance own + common_scale * common + G C G^T. One corner serves one
// landmark: the pairs are taken in falling NCC. `corner_used` is read and extended.
struct PoseCorrection {
  Eigen::Vector3d xi = Eigen::Vector3d::Zero();  // (forward, left, turn) in the body
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int inliers = 0;
  bool broken = false;  // it came out as no number or beyond slam/bounds.h: nothing is left of it
};
enum class CandidateKind { kPromotedRecent, kPromotedOld, kTentative };

class Associator {
 public:
  void layout(Arena& arena);
  void match(std::span<Candidate> candidates, CandidateKind kind, const PoseCorrection& correction,
             double common_scale, std::span<const Feature> features, const Map& map,
             double heading_rad, const AssociationSettings& settings, std::span<bool> corner_used);

 private:
  struct Pair {
    float score;
    std::int32_t candidate;
    std::int32_t corner;
  };
  std::span<Pair> pairs_;
};

// The pose correction on which the matches of `kind` agree: maximum a posteriori under the prior
// N(0, prior), matches weighted by Cauchy's function of their Mahalanobis distance (iteratively
// reweighted least squares, started at `start`), with the common error of each anchor's landmarks
// marginalised: those of one anchor must be neighbours. Marks the inliers.
PoseCorrection agree_on_pose(std::span<Candidate> candidates, CandidateKind kind,
                             std::span<const Feature> features, const Eigen::Matrix3d& prior,
                             const Eigen::Vector3d& start, double gate_sigma);

bool is_kind(const Candidate& candidate, CandidateKind kind);

}  // namespace zenith
