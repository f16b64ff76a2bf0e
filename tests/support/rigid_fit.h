#pragma once
// The rigid motion in the plane between two sets of paired points, in plain least squares: what
// trajectories and maps are aligned with before their error is measured. Apart from the system's
// own alignment on purpose.

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry.h"

namespace zenith {

struct RigidFit {
  Pose2 T_b_a;         // takes points of a to points of b
  double rms_m = 0.0;  // of the distances after the fit
  double max_m = 0.0;
};

inline RigidFit fit_points(const std::vector<Eigen::Vector2d>& a,
                           const std::vector<Eigen::Vector2d>& b) {
  RigidFit fit;
  if (a.empty() || a.size() != b.size()) return fit;
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_b = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  double dot = 0.0;
  double cross = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d p = a[i] - mean_a;
    const Eigen::Vector2d q = b[i] - mean_b;
    dot += p.dot(q);
    cross += p.x() * q.y() - p.y() * q.x();
  }
  const double theta = std::atan2(cross, dot);
  const Eigen::Vector2d t = mean_b - rotation(theta) * mean_a;
  fit.T_b_a = {t.x(), t.y(), theta};
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = (fit.T_b_a * a[i] - b[i]).norm();
    squares += distance * distance;
    fit.max_m = std::max(fit.max_m, distance);
  }
  fit.rms_m = std::sqrt(squares / n);
  return fit;
}

}  // namespace zenith
