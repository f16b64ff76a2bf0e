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

// The odometry since the last frame: mean motion in the body, and Q over (forward, left, turn).
struct MotionIncrement {
  Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// Standard deviations of odometry. Distance and turn are apart: unequal wheels and slip spoil the
// turn long before the distance (Borenstein, Feng, "UMBmark", 1995).
struct MotionNoise {
  double distance_per_sqrt_m = 0.002;  // m, after one metre
  double turn_per_sqrt_m = 0.02;       // rad, after one metre
  double lateral_per_sqrt_m = 0.002;   // m, sideways slip after one metre
  double floor_m = 0.0003;             // of one wheel's increment: quantisation, backlash
};

// No travel, no noise: a standing robot stays.
MotionIncrement motion_increment(const Wheels& wheels, const WheelTravel& travel,
                                 const MotionNoise& noise);

// Moves every particle by the mean motion (for `optimal`), or by a sample of it (for `motion`).
void move_by_mean(Particles& particles, const MotionIncrement& motion);
void move_by_sample(Particles& particles, const MotionIncrement& motion, Random& random);

// Accumulators of `optimal`, rows over the particles.
struct ProposalRows {
  static constexpr int kRows = 11;  // Lambda (6), eta (3), sum nu^T S^-1 nu, sum log|S|
  float* row[kRows] = {};
  void layout(Arena& arena, int particles);
  void clear(int particles);
};

// Adds one matched landmark; particles stand at the odometry's pose.
void add_to_proposal(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                     const Eigen::Vector2f& lever_m, float zx, float zy, float noise,
                     const ProposalRows& rows);

// Draws the poses and adds the weights.
void draw_from_proposal(Particles& particles, const MotionIncrement& motion,
                        const ProposalRows& rows, Random& random);

}  // namespace zenith
