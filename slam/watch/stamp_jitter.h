#pragma once
// How far the stamps of frames and wheels jitter against each other, from what the fit leaves of
// the turns: an interval whose ends are stamped wrongly by a few milliseconds misses the turn rate
// there times these.
//
//   e^2 = sigma_0^2 + sigma_t^2 (w_from^2 + w_to^2)        least squares, with forgetting

#include <algorithm>
#include <cmath>

namespace zenith {

class StampJitter {
 public:
  // Rest of an interval's turn, and the turn rates at its ends.
  void add(double rest_rad, double rate_from, double rate_to, double fade) {
    for (double* sum : {&n_, &x_, &y_, &xx_, &xy_, &yy_}) *sum *= fade;
    const double x = rate_from * rate_from + rate_to * rate_to;
    const double y = std::min(rest_rad * rest_rad, kMost_rad2);
    n_ += 1.0;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
  }

  // At least so much, with two and a half standard deviations; 0 while nothing is known.
  double sigma_s() const {
    // Straight driving tells nothing, and few turns may err for other reasons.
    if (!(n_ > kLeast && x_ * x_ > kLeastTurning * xx_)) return 0.0;
    const double sxx = xx_ - x_ * x_ / n_;
    const double sxy = xy_ - x_ * y_ / n_;
    const double syy = yy_ - y_ * y_ / n_;
    if (!(sxx > 0.0)) return 0.0;
    const double slope = sxy / sxx;
    const double error2 = std::max(0.0, syy - slope * sxy) / ((n_ - 2.0) * sxx);
    return std::sqrt(std::max(0.0, slope - 2.5 * std::sqrt(error2)));
  }

 private:
  static constexpr double kLeast = 30.0;
  static constexpr double kLeastTurning = 16.0;  // intervals, as if all turned alike
  static constexpr double kMost_rad2 = 0.005;    // 4 degrees: beyond, it is a slip

  double n_ = 0.0;
  double x_ = 0.0;
  double y_ = 0.0;
  double xx_ = 0.0;
  double xy_ = 0.0;
  double yy_ = 0.0;
};

}  // namespace zenith
