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

Eigen::Vector2d residual(const Candidate& c, const Feature& f, const Eigen::Vector3d& xi) {
  return Eigen::Vector2d(f.zx, f.zy) - c.m - c.G * xi;
}

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
    const Eigen::Vector2d centre = c.m + c.G * correction.xi;
    const Eigen::Matrix2d S =
        c.own + common_scale * c.common + c.G * correction.covariance * c.G.transpose();
    const Eigen::Matrix2d W = S.inverse();
    for (std::size_t k = 0; k < features.size(); ++k) {
      const Feature& f = features[k];
      if (corner_used[k] || !f.described) continue;
      const Eigen::Vector2d d(f.zx - centre.x(), f.zy - centre.y());
      const double r2 = d.squaredNorm();
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
    Eigen::Matrix3d lambda = information;
    Eigen::Vector3d eta = Eigen::Vector3d::Zero();
    for (const Candidate& c : candidates) {
      if (!is_kind(c, kind) || c.corner < 0) continue;
      const Feature& f = features[static_cast<std::size_t>(c.corner)];
      const Eigen::Matrix2d W = c.own.inverse();
      const Eigen::Vector2d d = residual(c, f, out.xi);
      const double weight = 1.0 / (1.0 + d.dot(W * d) / (kCauchyScale * kCauchyScale));
      lambda += weight * c.G.transpose() * W * c.G;
      eta += weight * c.G.transpose() * W * (d + c.G * out.xi);
    }
    const Eigen::LLT<Eigen::Matrix3d> llt(lambda);
    const Eigen::Vector3d next = llt.solve(eta);
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
