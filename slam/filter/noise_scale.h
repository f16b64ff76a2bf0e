#pragma once
// How noisy corners are, learned from the filter's own innovations.
//
// A corner's place errs by the lens's blur, the sensor's noise, the exposure's motion, the corner's
// own sliding: what is right for one camera is several times too small for another, and a filter
// that believes its corners too much follows the wrong ones and states errors that are too small.
// Two things are estimated, both so that a minority of wrong matches does not matter:
//
//   spread   the median of d^2 = e^T S^-1 e, S = H P H^T + kappa_1 sigma^2 I, is 2 ln 2 when
//   kappa_1
//            is right. Each frame tells the share of its matches above it; log kappa_1 follows by
//            stochastic approximation (Robbins, Monro 1951)
//   memory   of a landmark's residuals in two frames running: rho = sin(pi/2 E[sign(e) sign(e')])
//            (the sign covariance of two Gaussians, Sheppard 1899)
//
// The filter takes each frame's error for a new one. As much as n frames of an autoregressive error
// tell of its mean is told by n independent ones of variance
//
//   kappa sigma^2 = kappa_1 (1 + rho) / (1 - rho) sigma^2
//
// kappa stays within [1, kMostNoise^2]: the stated noise is the least, for what lasts longer than a
// few frames is not in these two.

#include <cmath>

namespace zenith {

class NoiseScale {
 public:
  static constexpr double kMostNoise = 8.0;  // times the stated standard deviation

  void reset() { *this = {}; }

  // One match of this frame: its squared innovation with the corner's variance times kappa_1.
  void add(double squared_innovation);
  // The same residual, of the same landmark, one component, in this frame and in the last one.
  void add_pair(double residual, double last_residual);
  // True: kappa changed. Frames with few matches tell nothing.
  bool end_frame();

  double kappa_1() const { return kappa_1_; }
  double memory() const { return memory_; }  // rho
  // The variance that a corner counts with, as a multiple of the stated one.
  double kappa() const { return kappa_; }
  double sigma_factor() const { return std::sqrt(kappa_); }
  // Enough frames were seen for kappa to be near the right value.
  bool settled() const { return frames_ >= kSettling; }

 private:
  double kappa_ = 1.0;
  double kappa_1_ = kStart;
  double memory_ = 1.0 / 3.0;
  double mean_sign_ = 0.2163;  // of memory_
  double pairs_weight_ = 0.0;
  int frames_ = 0;
  int matches_ = 0;
  int above_ = 0;
  int pairs_ = 0;
  int agreeing_ = 0;

  static constexpr int kSettling = 30;
  static constexpr double kStart = 0.5;
};

}  // namespace zenith
