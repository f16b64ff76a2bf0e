#pragma once
// From odometry and matched landmarks to new poses and weights, for each particle.
//
// `motion` (the paper's, II-B): x_t ~ p(x_t | x_{t-1}, u_t), weight p(z_t | x_t).
// `optimal` (FastSLAM 2.0: Montemerlo et al., IJCAI 2003): x_t ~ p(x_t | x_{t-1}, u_t, z_t), weight
// p(z_t | x_{t-1}, u_t). Around the odometry's pose, with xi = (forward, left, turn) in the body:
//
//   z - m = G xi + noise,   G = [-rho I | (m'_y, -m'_x)],   m' = m + rho lever
//   Lambda = Q^-1 + sum G^T S^-1 G,   eta = sum G^T S^-1 (z - m)
//   xi ~ N(Lambda^-1 eta, Lambda^-1)
//   2 log weight = -sum (nu^T S^-1 nu + log|S|) + eta^T Lambda^-1 eta - log|Lambda| + log|Q^-1|
//
// S is the landmark's innovation covariance with measurement noise, nu = z - m.

#include <Eigen/Core>

#include "platform/base/random.h"
#include "slam/filter/landmark.h"
#include "slam/filter/motion.h"

namespace zenith {

// Moves every particle by the mean motion.
void move_by_mean(Particles& particles, const Pose2& mean);
// Draws every particle's error of the motion that it was moved by.
void draw_from_motion(Particles& particles, const Eigen::Matrix3d& covariance, Random& random);

// Accumulators of `optimal`, rows over the particles.
struct ProposalRows {
  // Lambda (6), eta (3), sum nu^T S^-1 nu, sum log|S|; of one anchor sum G^T S^-1 u (3),
  // sum u^T S^-1 u, sum u^T S^-1 nu.
  static constexpr int kRows = 16;
  float* row[kRows] = {};
  void layout(Arena& arena, int particles);
  void clear(int particles);
};

// Adds one matched landmark; particles stand at the odometry's pose. With `shared` it has an error
// in common with the others of its anchor (depth_prior.h): they are added one after another, and
// then marginalise_shared() is called, before another anchor's. G is made with `rho`.
void add_to_proposal(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                     const Eigen::Vector2f& lever_m, const Sight& sight, float rho,
                     const ProposalRows& rows);
void marginalise_shared(int particles, const ProposalRows& rows);

// Draws the poses and adds the weights; the covariance is the motion's.
void draw_from_proposal(Particles& particles, const Eigen::Matrix3d& covariance,
                        const ProposalRows& rows, Random& random);

}  // namespace zenith
