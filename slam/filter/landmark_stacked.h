#pragma once
// One landmark seen by several robots in one time step (paper II-B, Eq. 2-3).
//
//   residual  e = [z^1 - m^1; ...; z^k - m^k]                    2k
//   Jacobian  H = [H^1; ...; H^k],  H^j = [R(theta_a - theta_j) | b_j]    2k x 3
//   update    S = H P H^T + N,   K = P H^T S^-1,   x += K e,   P -= K H P
//
// N is diagonal: the observations' variances. State, anchor and cameras as in landmark.h; each
// robot's camera is its own row of the same joint particles. Linear for given poses, so the update
// is exact and equals the k single ones.
//
// Each robot's weight was drawn as if it alone saw the landmark. Together they see it as
// N(e; 0, S), whose blocks off the diagonal are what the robots' views have in common:
//
//   log weight += log N(e; 0, S) - sum_j log N(e_j; 0, S_jj)

#include <span>

#include "slam/capacity.h"
#include "slam/filter/landmark.h"

namespace zenith {

struct StackedObservation {
  CameraRows camera;
  float zx = 0.0F;
  float zy = 0.0F;
  float noise = 0.0F;  // variance on each axis
};

// One to kMaxObservers observations. With `log_weight` the
// particles' weights learn what the observations have in common.
void update_landmark_stacked(const LandmarkRows& landmark,
                             std::span<const StackedObservation> observers, int particles,
                             double* log_weight = nullptr);

}  // namespace zenith
