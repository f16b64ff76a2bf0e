#pragma once
// How much turning is seen for the turning that the wheels tell: the quotient of two sums. Noise of
// either side averages out in it, while the slope of a regression is too small by what the wheels'
// own noise adds to their squares.
//
//   scale = sum sign(u2) (t - alpha1 u1) / sum |u2|          t: turn b / 2, u: see wheel_fit.h
//
// Over intervals in which the robot clearly turns, so that noise does not choose the sign. A
// balance of the wheels (alpha1) that wanders goes in with what the robot drives forward while it
// turns, as far as left and right turns do not cancel.

#include <algorithm>
#include <cmath>
#include <limits>

namespace zenith {

class TurnScale {
 public:
  // One interval: u as told, and the turn that was seen for it in metres, less alpha1 u1.
  void add(double forward_m, double told_m, double seen_m, double fade) {
    for (double* sum : {&forward_, &told_, &seen_, &tt_, &ts_, &ss_, &n_}) *sum *= fade;
    forward_ += told_m < 0.0 ? -forward_m : forward_m;
    const double told = std::abs(told_m);
    const double seen = told_m < 0.0 ? -seen_m : seen_m;
    n_ += 1.0;
    told_ += told;
    seen_ += seen;
    tt_ += told * told;
    ts_ += told * seen;
    ss_ += seen * seen;
  }

  double value() const { return told_ > 0.0 ? seen_ / told_ : 1.0; }

  // Of value(), from how the intervals scatter around it and from the balance.
  double sigma() const {
    if (n_ < kLeast) return std::numeric_limits<double>::infinity();
    const double s = value();
    const double rest = std::max(0.0, ss_ - 2.0 * s * ts_ + s * s * tt_);
    return std::hypot(std::sqrt(rest), kBalanceSigma * forward_) / told_;
  }

 private:
  static constexpr double kLeast = 5.0;
  static constexpr double kBalanceSigma = 0.0015;

  double n_ = 0.0;
  double forward_ = 0.0;
  double told_ = 0.0;
  double seen_ = 0.0;
  double tt_ = 0.0;
  double ts_ = 0.0;
  double ss_ = 0.0;
};

}  // namespace zenith
