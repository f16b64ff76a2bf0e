#include "tools/report/ate.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zenith::tools {
namespace {

Eigen::Vector2d mean_of(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

Pose2 align_rigid(std::span<const Eigen::Vector2d> p, std::span<const Eigen::Vector2d> q) {
  assert(p.size() == q.size());
  if (p.empty()) return {};
  const Eigen::Vector2d mean_p = mean_of(p);
  const Eigen::Vector2d mean_q = mean_of(q);
  double cross = 0.0;
  double dot = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d a = p[i] - mean_p;
    const Eigen::Vector2d b = q[i] - mean_q;
    cross += a.x() * b.y() - a.y() * b.x();
    dot += a.dot(b);
  }
  const double theta = std::atan2(cross, dot);
  const Eigen::Vector2d t = mean_q - rotation(theta) * mean_p;
  return {t.x(), t.y(), theta};
}

TrajectoryError absolute_trajectory_error(std::span<const Eigen::Vector2d> estimate,
                                          std::span<const Eigen::Vector2d> truth) {
  TrajectoryError error;
  if (estimate.empty()) return error;
  error.T_truth_estimate = align_rigid(estimate, truth);
  double sum = 0.0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const double distance = (truth[i] - error.T_truth_estimate * estimate[i]).norm();
    sum += distance * distance;
    error.max_m = std::max(error.max_m, distance);
  }
  error.rmse_m = std::sqrt(sum / static_cast<double>(estimate.size()));
  return error;
}

}  // namespace zenith::tools
