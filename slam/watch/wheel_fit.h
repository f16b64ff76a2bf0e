#pragma once
// What the camera saw against what the wheels told, over many intervals: least squares with
// forgetting, for a range of delays between the two clocks.
//
//   u = ((l + r) / 2, (r - l) / 2)          of the wheels, metres
//   turn b / 2 = alpha . u,   shift = beta . u      b: track width
//
// A right set-up has alpha = (0, 1) and beta_1 = (1 / h, 0), h being the height of what is seen;
// beta_2 holds the camera's lever arm. The delay is the one with the smallest rest in the turns.

#include <array>
#include <cmath>
#include <complex>

#include "platform/base/time.h"

namespace zenith {

// Sums over intervals for one delay.
struct FitSums {
  double n = 0.0;
  double u11 = 0.0, u12 = 0.0, u22 = 0.0;
  double t1 = 0.0, t2 = 0.0, tt = 0.0;  // turns b / 2
  std::complex<double> s1, s2;          // shifts, forward + i left
  double ff = 0.0, ll = 0.0;            // squares of the shifts forward, left

  void add(double u1, double u2, double turn_m, std::complex<double> shift, double weight);
  void fade(double factor);
};

struct WheelFit {
  bool known = false;  // both of u were moved enough
  double n = 0.0;      // intervals, faded
  double alpha1 = 0.0, alpha2 = 0.0;
  double alpha1_sigma = 0.0, alpha2_sigma = 0.0;
  std::complex<double> beta1, beta2;
  double beta1_sigma = 0.0, beta2_sigma = 0.0;  // of both parts
  // Of the parts to the left alone, which do not depend on how high the ceiling is.
  double beta1_left_sigma = 0.0, beta2_left_sigma = 0.0;
  double turn_rest = 0.0;  // of the turns' sum of squares, what the wheels do not explain: 0 to 1
  double turn_rest_m2 = 0.0;  // mean square of an interval
};

WheelFit fit(const FitSums& sums);

class DelayedFits {
 public:
  static constexpr Duration kStep = {20'000'000};
  static constexpr int kSide = 20;  // delays to each side of 0
  static constexpr int kDelays = 2 * kSide + 1;
  static Duration delay(int i) { return {kStep.ns * (i - kSide)}; }
  static constexpr Duration longest() { return {kStep.ns * kSide}; }

  void reset() { sums_ = {}; }
  void fade(double factor);
  FitSums& sums(int i) { return sums_[static_cast<std::size_t>(i)]; }

  struct Best {
    WheelFit fit;  // at the best delay
    double delay_s = 0.0;
    double sigma_s = 0.0;
    double gain = 0.0;  // rest without a delay / rest with it
  };
  // Positive: the wheels' stamps are late.
  Best best() const;

 private:
  std::array<FitSums, kDelays> sums_ = {};
};

}  // namespace zenith
