#pragma once
// What the landmarks of one anchor have in common: the prior of their inverse height.
//
// A landmark starts with rho ~ N(mean, sigma^2), over the heights that a landmark may have. The
// landmarks of a frame mostly lie on one ceiling: all of them are too high or too low by the prior,
// and together. Taken as independent, n of them would measure the robot's first distances to
// sigma / (mean sqrt(n)) and outvote the wheels, from which alone the metre can come. So what an
// anchor's landmarks tell of the pose is told with one more unknown, their common error of rho:
// eta times the prior's range, which is 4 sigma.
//
//   x_i - x_true = P P_0^-1 (0, 0, range eta) = P_i,rho range / sigma^2 eta    after any updates
//   z_i - m_i = G_i xi + u_i eta + noise,   u_i = shared (H_i P_i)_rho,   shared = range / sigma^2
//   noise ~ N(0, S_i),   eta ~ N(0, 1), one for each anchor and frame
//
// P_0 is the covariance at the start, where rho is independent of (ax, ay); S, H, G as in
// landmark.h and proposal.h. S still holds the landmark's own prior, since heights do differ. With
// eta marginalised (a Schur complement of size one) no number of landmarks moves the robot's
// distance by the prior, whatever it is; what they tell across their parallax, and of depth as far
// as the robot's motion has shown it, stays. u vanishes with the prior's share in P.

//
// A second way in which unknown depths can move the robot: G = dm/dxi holds rho. Where rho is known
// badly, an estimate that is too large by e makes a residual of -e b and a G that is too large by
// e, and sum G^T S^-1 (z - m) has the sign of e^2, whatever e is: shorter steps than the robot's.
// So G takes rho as far as it is told apart from the others in view (DepthSpread).

#include <algorithm>
#include <cmath>

namespace zenith {

struct DepthPrior {
  double mean = 0.0;    // of rho, 1 / m
  double sigma = 0.0;   // likewise
  double shared = 0.0;  // range / sigma^2, m

  // For landmarks between so many metres above the camera.
  static DepthPrior between(double lowest_m, double highest_m) {
    constexpr double kNearest_m = 0.3;
    const double most = 1.0 / std::max(lowest_m, kNearest_m);
    const double least = std::min(1.0 / std::max(highest_m, kNearest_m), kNarrowest * most);
    const double sigma = 0.25 * (most - least);
    return {std::sqrt(most * least), sigma, 4.0 / sigma};
  }

  // What is left of the common error of rho, as a share of rho, is not worth a thought.
  bool is_settled(double rho, double rho_variance) const {
    return rho_variance * shared < kSettled * std::abs(rho);
  }

 private:
  static constexpr double kNarrowest = 0.9;
  static constexpr double kSettled = 3e-4;
};

// The inverse heights in view: their mean and their spread, without the errors of their estimates.
// Empirical Bayes (Efron, Morris, "Stein's paradox in statistics", 1977):
//
//   mean = sum w rho / sum w,   variance = sum w^2 ((rho - mean)^2 - P) / sum w^2,   w = 1 / (P +
//   variance)
class DepthSpread {
 public:
  // `each(visit)` calls visit(rho, variance) for every landmark, the same ones each time.
  template <typename Each>
  explicit DepthSpread(Each&& each) {
    for (int round = 0; round < kRounds; ++round) {
      double weights = 0.0, sum = 0.0;
      each([&](double rho, double P) {
        const double w = 1.0 / (P + variance_);
        weights += w;
        sum += w * rho;
      });
      if (!(weights > 0.0)) return;
      mean_ = sum / weights;
      double squares = 0.0, excess = 0.0;
      each([&](double rho, double P) {
        const double w = 1.0 / (P + variance_);
        squares += w * w;
        excess += w * w * ((rho - mean_) * (rho - mean_) - P);
      });
      variance_ = std::max(excess / squares, kLeast);
    }
  }

  // The expectation of a landmark's rho, of which an estimate and its variance are given.
  double expected(double rho, double P) const {
    return mean_ + variance_ / (variance_ + P) * (rho - mean_);
  }

 private:
  static constexpr int kRounds = 4;
  static constexpr double kLeast = 1e-8;
  double mean_ = 0.0;
  double variance_ = 0.01;
};

}  // namespace zenith
