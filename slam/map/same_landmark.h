#pragma once
// When landmarks of two maps are one, for all that join maps: a peer's with the own one
// (fleet/duplicates.h), two filters (map_import.h), a stored one with the present one
// (fleet/continued_map.h).
//
//   alike       their places agree within 3 sigma of both, heights within 0.3 m, and two looks
//               that point the same way are similar: NCC above 0.6
//   one corner  they lie within 5 cm of each other, whatever they look like: a detector keeps
//               corners further apart than that. Counts only where the maps surely belong together

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Core>
#include <Eigen/LU>

#include "platform/base/fixed_vector.h"
#include "slam/map/map.h"

namespace zenith {

inline constexpr float kSameNcc = 0.6F;
inline constexpr double kSameSigmas = 3.0;
inline constexpr double kSameHeight_m = 0.3;
inline constexpr double kSameTurn_rad = 0.5;  // between the directions of two looks
inline constexpr double kOneCorner_m = 0.05;
// Errors of the maps that the landmarks' covariances do not tell: their drift in common.
inline constexpr double kMapError_m = 0.025;
// Landmarks whose place is hardly known are not searched in the whole map.
inline constexpr double kSameReach_m = 0.4;

struct LookView {
  const CompactPatch* patch = nullptr;
  float direction_rad = 0.0F;
};
using LookViews = FixedVector<LookView, kMaxAppearances>;

// Of a landmark in the own map; valid as long as its looks are.
LookViews looks_of(const Map& map, const LandmarkInfo& landmark);

// The best NCC of any two looks that point the same way once b's are turned by `turn_rad`; 0: none.
float best_similarity(std::span<const LookView> a, std::span<const LookView> b, double turn_rad);

// Of the landmarks of one map, offered one after the other, the one that a landmark of another map
// is. O(1) each, with at most 20 x 20 comparisons of looks for those near by.
class TwinSearch {
 public:
  // The other map's landmark, moved into this one's frame: P with the transform's uncertainty.
  TwinSearch(const Eigen::Vector3d& at, const Eigen::Matrix2d& P)
      : at_(at), P_(P), reach_(std::min(kSameSigmas * std::sqrt(P.trace()) + 0.08, kSameReach_m)) {}

  // Whether a landmark there is worth offering: cheap.
  bool is_near(float x_m, float y_m, float z_m) const {
    const double dx = static_cast<double>(x_m) - at_.x();
    const double dy = static_cast<double>(y_m) - at_.y();
    return dx * dx + dy * dy <= 4.0 * reach_ * reach_ &&
           std::abs(static_cast<double>(z_m) - at_.z()) <= kSameHeight_m;
  }

  // One that is near. `similarity()`: best_similarity() of both, asked for only if it matters.
  template <typename Similarity>
  void offer(int slot, const Eigen::Vector3d& place, const Eigen::Matrix2d& covariance,
             Similarity similarity) {
    any_near_ = true;
    const Eigen::Vector3d d = place - at_;
    if (d.squaredNorm() < nearest_m2_) {
      nearest_m2_ = d.squaredNorm();
      one_corner_ = slot;
    }
    const Eigen::Vector2d flat = d.head<2>();
    if (flat.squaredNorm() > reach_ * reach_ || !may_be_one(flat, covariance)) return;
    const float ncc = similarity();
    if (ncc <= best_) return;
    best_ = ncc;
    alike_ = slot;
  }

  bool any_near() const { return any_near_; }
  int alike() const { return alike_; }  // the most similar one; -1: none
  int one_corner() const { return one_corner_; }
  int twin() const { return alike_ >= 0 ? alike_ : one_corner_; }

 private:
  bool may_be_one(const Eigen::Vector2d& d, const Eigen::Matrix2d& covariance) const {
    const Eigen::Matrix2d S =
        P_ + covariance + kMapError_m * kMapError_m * Eigen::Matrix2d::Identity();
    return d.dot(S.inverse() * d) < kSameSigmas * kSameSigmas;
  }

  Eigen::Vector3d at_;
  Eigen::Matrix2d P_;
  double reach_;
  bool any_near_ = false;
  int alike_ = -1;
  int one_corner_ = -1;
  float best_ = kSameNcc;
  double nearest_m2_ = kOneCorner_m * kOneCorner_m;
};

}  // namespace zenith
