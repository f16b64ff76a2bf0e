#pragma once
// The zero of a function between two places where its sign differs: regula falsi, the Illinois way
// (Dowell, Jarratt, BIT 1971). Needs no derivative, and stays within its bracket.

#include <cmath>

namespace zenith {

// f(low) and f(high) differ in sign or are zero. To about the last digits of the answer.
template <typename Function>
double solve_between(Function f, double low, double high) {
  constexpr int kMostSteps = 100;
  constexpr int kHalveEvery = 4;  // for curves near a pole, which the secants follow slowly
  double f_low = f(low);
  double f_high = f(high);
  for (int i = 1; i <= kMostSteps && f_high != 0.0 && f_high != f_low; ++i) {
    const double at = i % kHalveEvery == 0 ? 0.5 * (low + high)
                                           : (low * f_high - high * f_low) / (f_high - f_low);
    if (std::abs(at - high) <= 2e-16 * std::abs(at)) return at;
    const double f_at = f(at);
    if ((f_at > 0.0) == (f_high > 0.0)) {
      f_low *= 0.5;
    } else {
      low = high;
      f_low = f_high;
    }
    high = at;
    f_high = f_at;
  }
  return high;
}

}  // namespace zenith
