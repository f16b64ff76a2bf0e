#pragma once
// Scaramuzza, Martinelli, Siegwart, "A flexible technique for accurate omnidirectional camera
// calibration and structure from motion", ICVS 2006, in OCamCalib's conventions: rho in pixels, the
// polynomial negative on the axis.
//
//   (rho e, f(rho)) is the ray of the sensor's point rho e:  tan(theta) = rho / -f(rho)
//   f = a0 + a1 rho + a2 rho^2 + ..
//   rho = b0 + b1 (theta - pi / 2) + b2 (theta - pi / 2)^2 + ..
//
// The b are what OCamCalib's world2cam() reads, fitted to f within a hundredth of a pixel. Where
// they are given they are the lens; otherwise f is solved for rho.

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <Eigen/Core>

#include "slam/image/lens.h"
#include "slam/image/lens/solve.h"

namespace zenith::scaramuzza {

inline constexpr double kDomain_rad = 3.14;

template <std::size_t N>
double horner(const std::array<double, N>& a, double x) {
  double sum = 0.0;
  for (std::size_t i = N; i-- > 0;) sum = sum * x + a[i];
  return sum;
}

inline bool has_inverse(const Lens& lens) {
  return lens.inverse_polynomial != decltype(lens.inverse_polynomial){};
}

// The angle of the sensor's radius.
inline double theta_of(const Lens& lens, double rho_px) {
  return std::atan2(rho_px, -horner(lens.polynomial, rho_px));
}

// The least radius with this angle, up to the image's diagonal from the axis; no number where there
// is none.
inline double solved_rho(const Lens& lens, double theta_rad) {
  constexpr int kSteps = 48;
  const double step = std::hypot(lens.width_px, lens.height_px) / kSteps;
  double low = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const double high = i * step;
    if (theta_of(lens, high) < theta_rad) {
      low = high;
      continue;
    }
    return solve_between([&](double at) { return theta_of(lens, at) - theta_rad; }, low, high);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

inline double rho(const Lens& lens, double theta_rad) {
  if (has_inverse(lens)) {
    return horner(lens.inverse_polynomial, theta_rad - 0.5 * std::numbers::pi);
  }
  return theta_rad <= 0.0 ? 0.0 : solved_rho(lens, theta_rad);
}

// The sensor's plane in columns and rows: m of the point x = rho e.
inline Eigen::Vector2d shear(const Lens& lens, const Eigen::Vector2d& x) {
  return {lens.e * x.y() + x.x(), lens.c * x.y() + lens.d * x.x()};
}

inline Eigen::Vector2d unshear(const Lens& lens, const Eigen::Vector2d& m) {
  const double det = lens.c - lens.d * lens.e;
  return {(lens.c * m.x() - lens.e * m.y()) / det, (m.y() - lens.d * m.x()) / det};
}

}  // namespace zenith::scaramuzza
