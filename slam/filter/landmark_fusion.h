#pragma once
// Two estimates of one landmark, made from different anchors, become one: for each particle.
//
// As the landmark is linear in its state, the state (ax, ay, rho) seen from anchor B is a linear
// function of the state seen from anchor A (see landmark.h with the camera at anchor B):
//
//   s_B = F s_A,   F = [ R(theta_A - theta_B) | R(theta_B)^T (c_A - c_B) ]
//                      [         0   0        |            1              ]
//
// so that B's Gaussian is one observation of A's state with noise P_B: a Kalman update.
//
// The two disagree by d^2 = e^T (F P_A F^T + P_B)^-1 e. Maps bend, so d^2 is often more than its
// expectation 3; both covariances are then scaled by d^2 / 3, the Birge ratio, which leaves the
// fused state where it is and its covariance as large as the disagreement demands.

#include <span>

#include "slam/filter/landmark.h"
#include "slam/geometry.h"

namespace zenith {

// Fuses `other` into `own`. Particle i of `other` lives in a frame that T_own_other[i] takes into
// own's; its anchor is moved by it.
void fuse_landmark(const LandmarkRows& own, const LandmarkRows& other,
                   std::span<const Pose2> T_own_other);

}  // namespace zenith
