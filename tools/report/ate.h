#pragma once
// Absolute trajectory error: the estimate laid over the truth by the best rigid transform of the
// plane, then the root mean square of what remains.
//
//   minimise over T in SE(2):  sum_i | q_i - T p_i |^2
//   theta = atan2( sum cross(p_i - mean p, q_i - mean q), sum dot(p_i - mean p, q_i - mean q) )
//   t     = mean q - R(theta) mean p
//
// Source: Umeyama 1991 in the plane, without scale; Sturm et al. 2012 for the error.

#include <span>
#include <vector>

#include <Eigen/Core>

#include "slam/geometry.h"

namespace zenith::tools {

// T with q ~ T * p. As many `p` as `q`; the identity when there are none.
Pose2 align_rigid(std::span<const Eigen::Vector2d> p, std::span<const Eigen::Vector2d> q);

struct TrajectoryError {
  double rmse_m = 0.0;
  double max_m = 0.0;
  Pose2 T_truth_estimate;  // the alignment that was used
};

TrajectoryError absolute_trajectory_error(std::span<const Eigen::Vector2d> estimate,
                                          std::span<const Eigen::Vector2d> truth);

}  // namespace zenith::tools
