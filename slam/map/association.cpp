#include "slam/map/association.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "slam/bounds.h"
#include "slam/geometry.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxPairs = 8192;
constexpr double kCauchyScale = 2.0;  // Mahalanobis distance at which a match counts half

double squared_distance(const Eigen::Vector2d& d, const Eigen::Matrix2d& S) {
  return d.dot(S.inverse() * d);
}

// Of a corner from where a candidate may be with any depth that it may have.
Eigen::Vector2d off_depth(const Candidate& c, const Eigen::Vector2d& d) {
  const double length2 = c.u.squaredNorm();
  if (length2 == 0.0) return d;
  return d - std::clamp(d.dot(c.u) / length2, -1.0, 1.0) * c.u;
}

Eigen::Vector2d residual(const Candidate& c, const Feature& f, const Eigen::Vector3d& xi) {
  return seen_at(c, f).cast<double>() - c.m - c.G * xi;
}

// The information of matches about xi.
class NormalEquations {
 public:
  explicit NormalEquations(const Eigen::Matrix3d& prior) : lambda_(prior) {}

  // `residual` at xi = 0.
  void add(const Candidate& c, const Eigen::Vector2d& residual, double weight = 1.0) {
    if (c.anchor != anchor_) marginalise();
    anchor_ = c.anchor;
    const Eigen::Matrix2d W = weight * c.own.inverse();
    lambda_ += c.G.transpose() * W * c.G;
    eta_ += c.G.transpose() * W * residual;
    if (c.shared == 0.0) return;
    const Eigen::Vector2d Wu = W * c.u;
    shared_xi_ += c.G.transpose() * Wu;
    shared_ += Wu.dot(c.u);
    shared_residual_ += Wu.dot(residual);
  }
  Eigen::LLT<Eigen::Matrix3d> solve(Eigen::Vector3d& xi) {
    marginalise();
    const Eigen::LLT<Eigen::Matrix3d> llt(lambda_);
    xi = llt.solve(eta_);
    return llt;
  }

 private:
  void marginalise() {
    lambda_ -= shared_xi_ * shared_xi_.transpose() / (1.0 + shared_);
    eta_ -= shared_xi_ * (shared_residual_ / (1.0 + shared_));
    shared_xi_.setZero();
    shared_ = shared_residual_ = 0.0;
  }

  Eigen::Matrix3d lambda_;
  Eigen::Vector3d eta_ = Eigen::Vector3d::Zero();
  int anchor_ = -1;
  Eigen::Vector3d shared_xi_ = Eigen::Vector3d::Zero();  // sum G^T W u, of anchor_
  double shared_ = 0.0;                                  // sum u^T W u
  double shared_residual_ = 0.0;                         // sum u^T W residual
};

int mark_inliers(std::span<Candidate> candidates, CandidateKind kind,
                 std::span<const Feature> features, const PoseCorrection& correction,
                 double gate_sigma) {
  int count = 0;
  for (Candidate& c : candidates) {
    if (!is_kind(c, kind) || c.corner < 0) continue;
    const Eigen::Vector2d d =
        residual(c, features[static_cast<std::size_t>(c.corner)], correction.xi);
    c.inlier = squared_distance(d, c.own) < gate_sigma * gate_sigma;
    count += c.inlier ? 1 : 0;
  }
  return count;
}

}  // namespace

bool is_kind(const Candidate& c, CandidateKind kind) {
  if (!c.promoted) return kind == CandidateKind::kTentative;
  return kind == (c.old ? CandidateKind::kPromotedOld : CandidateKind::kPromotedRecent);
}

void Associator::layout(Arena& arena) {
  pairs_ = arena.take<Pair>(kMaxPairs);
}

void Associator::match(std::span<Candidate> candidates, CandidateKind kind,
                       const PoseCorrection& correction, double common_scale,
                       std::span<const Feature> features, const Map& map, double heading_rad,
                       const AssociationSettings& settings, std::span<bool> corner_used) {
  std::size_t count = 0;
  const double gate2 = settings.gate_sigma * settings.gate_sigma;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Candidate& c = candidates[i];
    if (!is_kind(c, kind)) continue;
    c.corner = -1;
    c.inlier = false;
    c.shift.setZero();
    c.shift_px.setZero();
    const Eigen::Vector2d centre = c.m + c.G * correction.xi;
    const Eigen::Matrix2d S =
        c.own + common_scale * c.common + c.G * correction.covariance * c.G.transpose();
    const Eigen::Matrix2d W = S.inverse();
    for (std::size_t k = 0; k < features.size(); ++k) {
      const Feature& f = features[k];
      if (corner_used[k] || !f.described) continue;
      const Eigen::Vector2d d(f.zx - centre.x(), f.zy - centre.y());
      const double r2 = off_depth(c, d).squaredNorm();
      if (r2 > settings.max_radius * settings.max_radius) continue;
      if (r2 > settings.min_radius * settings.min_radius && d.dot(W * d) > gate2) continue;
      const auto direction =
          static_cast<float>(wrap_angle(heading_rad + static_cast<double>(f.orientation_rad)));
      const float ncc = map.best_ncc(c.slot, f.patch, direction, settings.max_turn_rad);
      if (ncc < settings.ncc_min || count == pairs_.size()) continue;
      // Between equal looks the nearer one wins.
      const auto nearness = static_cast<float>(0.1 * std::min(d.dot(W * d) / gate2, 1.0));
      const float score = ncc - nearness;
      if (!std::isfinite(score)) continue;  // they could not be sorted
      pairs_[count++] = {score, static_cast<std::int32_t>(i), static_cast<std::int32_t>(k)};
    }
  }
  std::sort(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Pair& a, const Pair& b) {
              if (a.score != b.score) return a.score > b.score;
              return a.candidate != b.candidate ? a.candidate < b.candidate : a.corner < b.corner;
            });
  for (std::size_t p = 0; p < count; ++p) {
    Candidate& c = candidates[static_cast<std::size_t>(pairs_[p].candidate)];
    const auto k = static_cast<std::size_t>(pairs_[p].corner);
    if (c.corner >= 0 || corner_used[k]) continue;
    c.corner = pairs_[p].corner;
    c.ncc = pairs_[p].score;
    corner_used[k] = true;
  }
}

PoseCorrection agree_on_pose(std::span<Candidate> candidates, CandidateKind kind,
                             std::span<const Feature> features, const Eigen::Matrix3d& prior,
                             const Eigen::Vector3d& start, double gate_sigma) {
  const Eigen::Matrix3d information =
      (prior + 1e-9 * Eigen::Matrix3d::Identity()).llt().solve(Eigen::Matrix3d::Identity());
  PoseCorrection out;
  out.xi = start;
  for (int iteration = 0; iteration < 10; ++iteration) {
    NormalEquations equations(information);
    for (const Candidate& c : candidates) {
      if (!is_kind(c, kind) || c.corner < 0) continue;
      const Feature& f = features[static_cast<std::size_t>(c.corner)];
      const Eigen::Vector2d d = residual(c, f, out.xi);
      const double weight =
          1.0 / (1.0 + squared_distance(d, c.own) / (kCauchyScale * kCauchyScale));
      equations.add(c, d + c.G * out.xi, weight);
    }
    Eigen::Vector3d next;
    const auto llt = equations.solve(next);
    const double change = (next - out.xi).norm();
    out.xi = next;
    out.covariance = llt.solve(Eigen::Matrix3d::Identity());
    if (change < 1e-6) break;
  }
  const bool usable = out.xi.array().abs().maxCoeff() <= kFarthest_m &&
                      std::isfinite(out.xi.sum()) && out.covariance.allFinite();
  if (!usable) {
    out = PoseCorrection{};
    out.broken = true;
  }
  out.inliers = mark_inliers(candidates, kind, features, out, usable ? gate_sigma : 0.0);
  return out;
}

}  // namespace zenith
