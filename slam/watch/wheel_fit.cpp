#include "slam/watch/wheel_fit.h"

#include <algorithm>
#include <limits>

namespace zenith {
namespace {

// Of a turn, of a shift: intervals that fit better than this are not believed to.
constexpr double kTurnFloor_m2 = 1e-7;  // 0.1 degrees at 0.4 m
constexpr double kShiftFloor = 4e-6;    // 0.2 pixels

double turn_rest(const FitSums& s) {
  const double det = s.u11 * s.u22 - s.u12 * s.u12;
  if (!(det > 1e-12)) return s.tt;
  const double a1 = (s.u22 * s.t1 - s.u12 * s.t2) / det;
  const double a2 = (s.u11 * s.t2 - s.u12 * s.t1) / det;
  return std::max(0.0, s.tt - a1 * s.t1 - a2 * s.t2);
}

}  // namespace

void FitSums::add(double u1, double u2, double turn_m, std::complex<double> shift, double w) {
  n += w;
  u11 += w * u1 * u1;
  u12 += w * u1 * u2;
  u22 += w * u2 * u2;
  t1 += w * u1 * turn_m;
  t2 += w * u2 * turn_m;
  tt += w * turn_m * turn_m;
  s1 += w * u1 * shift;
  s2 += w * u2 * shift;
  ff += w * shift.real() * shift.real();
  ll += w * shift.imag() * shift.imag();
}

void FitSums::fade(double f) {
  for (double* sum : {&n, &u11, &u12, &u22, &t1, &t2, &tt, &ff, &ll}) *sum *= f;
  s1 *= f;
  s2 *= f;
}

WheelFit fit(const FitSums& s) {
  WheelFit out;
  out.n = s.n;
  const double det = s.u11 * s.u22 - s.u12 * s.u12;
  if (!(s.n > 4.0 && det > 1e-9)) return out;
  out.known = true;
  out.alpha1 = (s.u22 * s.t1 - s.u12 * s.t2) / det;
  out.alpha2 = (s.u11 * s.t2 - s.u12 * s.t1) / det;
  out.beta1 = (s.u22 * s.s1 - s.u12 * s.s2) / det;
  out.beta2 = (s.u11 * s.s2 - s.u12 * s.s1) / det;
  const double rest = turn_rest(s);
  out.turn_rest = s.tt > 0.0 ? rest / s.tt : 0.0;
  out.turn_rest_m2 = rest / s.n;
  const double turn2 = std::max(rest / (s.n - 2.0), kTurnFloor_m2);
  const double forward = s.ff - out.beta1.real() * s.s1.real() - out.beta2.real() * s.s2.real();
  const double left = s.ll - out.beta1.imag() * s.s1.imag() - out.beta2.imag() * s.s2.imag();
  const double shift2 = std::max((forward + left) / (2.0 * (s.n - 2.0)), kShiftFloor);
  const double left2 = std::max(left / (s.n - 2.0), kShiftFloor);
  out.alpha1_sigma = std::sqrt(turn2 * s.u22 / det);
  out.alpha2_sigma = std::sqrt(turn2 * s.u11 / det);
  out.beta1_sigma = std::sqrt(shift2 * s.u22 / det);
  out.beta2_sigma = std::sqrt(shift2 * s.u11 / det);
  out.beta1_left_sigma = std::sqrt(left2 * s.u22 / det);
  out.beta2_left_sigma = std::sqrt(left2 * s.u11 / det);
  return out;
}

void DelayedFits::fade(double factor) {
  for (FitSums& sums : sums_) sums.fade(factor);
}

DelayedFits::Best DelayedFits::best() const {
  std::array<double, kDelays> rest;
  std::transform(sums_.begin(), sums_.end(), rest.begin(), turn_rest);
  const auto least = std::min_element(rest.begin(), rest.end());
  // Where nothing turned, all delays are alike.
  const auto at =
      *least < rest[kSide] ? static_cast<std::size_t>(least - rest.begin()) : std::size_t{kSide};
  const int best = static_cast<int>(at);
  const double floor = kTurnFloor_m2 * sums_[at].n;
  Best out;
  out.fit = fit(sums_[at]);
  out.gain = (rest[kSide] + floor) / (rest[at] + floor);
  out.delay_s = delay(best).seconds();
  out.sigma_s = std::numeric_limits<double>::infinity();
  if (best == 0 || best == kDelays - 1) return out;
  // The parabola through the three rests: its lowest point, and where it has risen by one
  // interval's.
  const double slope = 0.5 * (rest[at + 1] - rest[at - 1]);
  const double bend = rest[at + 1] - 2.0 * rest[at] + rest[at - 1];
  if (!(bend > 0.0)) return out;
  out.delay_s -= std::clamp(slope / bend, -1.0, 1.0) * kStep.seconds();
  const double each = std::max(rest[at] / std::max(sums_[at].n - 2.0, 1.0), kTurnFloor_m2);
  out.sigma_s = std::sqrt(2.0 * each / bend) * kStep.seconds();
  return out;
}

}  // namespace zenith
