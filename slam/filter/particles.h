#pragma once
// The particle set of one robot: poses of base_link in the start frame, log weights, and the
// camera's place that follows from them (paper II-B).

#include <cmath>
#include <span>

#include <Eigen/Core>

#include "platform/base/arena.h"
#include "slam/filter/rows.h"
#include "slam/geometry.h"
#include "slam/kernels/rows/rows.h"

namespace zenith {

struct RepairCounters;

struct Particles {
  int count = 0;
  std::span<double> x_m;
  std::span<double> y_m;
  std::span<double> theta_rad;
  std::span<double> log_weight;  // any common offset; see normalise_weights()
  std::span<double> weight;      // normalised, after normalise_weights()
  CameraRows camera;

  void layout(Arena& arena, int particles) {
    count = particles;
    const auto n = static_cast<std::size_t>(row_stride(particles));
    x_m = arena.take<double>(n);
    y_m = arena.take<double>(n);
    theta_rad = arena.take<double>(n);
    log_weight = arena.take<double>(n);
    weight = arena.take<double>(n);
    camera.x = arena.take<float>(n).data();
    camera.y = arena.take<float>(n).data();
    camera.cos = arena.take<float>(n).data();
    camera.sin = arena.take<float>(n).data();
  }

  Pose2 pose(int i) const {
    const auto k = static_cast<std::size_t>(i);
    return {x_m[k], y_m[k], theta_rad[k]};
  }
  void set_pose(int i, const Pose2& pose) {
    const auto k = static_cast<std::size_t>(i);
    x_m[k] = pose.x_m;
    y_m[k] = pose.y_m;
    theta_rad[k] = pose.theta_rad;
  }
};

// Fills particles.camera for a camera at `lever_m` in base_link.
void place_cameras(Particles& particles, const Eigen::Vector2d& lever_m);

// log_weight -> weight (sum 1), log_weight shifted so that the largest is 0.
// Returns the effective sample size 1 / sum w^2 (Kong, Liu, Wong 1994).
// A log weight that is no number, or infinite, becomes -infinity: no weight. When no other is left
// all particles weigh alike. Both are counted.
double normalise_weights(Particles& particles, RepairCounters& repairs);

// Weighted mean and covariance. The mean is the group's: the pose from which the particles' errors,
// as logarithms in SE(2), add up to nothing. The mean of a motion's end is then the motion from the
// mean, mean(x_i u) = mean(x_i) u, however far the headings spread, where a mean over coordinates
// lies inside of the arc on which the particles are (Pennec, Arsigny, "Exponential barycenters of
// the canonical Cartan connection and invariant means on Lie groups", 2012).
//
//   sum w_i phi_i = 0,   sum w_i V(phi_i)^-1 (p_i - p) = 0,   phi_i = theta_i - theta
//   V(phi)^-1 = [a, phi / 2; -phi / 2, a],   a = (phi / 2) cot(phi / 2)
PoseEstimate estimate_pose(const Particles& particles);

}  // namespace zenith
