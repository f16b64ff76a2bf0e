#pragma once
// The equidistant projection with its derivatives, for fits: without the end of the lens's curve,
// which a fit may cross on its way.

#include <cmath>

#include <Eigen/Core>

#include "slam/image/lens/equidistant.h"

namespace zenith::tools {

// fu, fv, cu, cv, k1 .. k4.
inline constexpr int kLensSize = 8;
using LensVector = Eigen::Matrix<double, kLensSize, 1>;
using LensMatrix = Eigen::Matrix<double, kLensSize, kLensSize>;

struct Projection {
  Eigen::Vector2d uv_px;
  Eigen::Matrix<double, 2, kLensSize> by_lens;
  Eigen::Matrix<double, 2, 3> by_point;
};

// Pixel of a point in the camera frame.
inline Eigen::Vector2d project_equidistant(const Lens& lens, const Eigen::Vector3d& p) {
  const double r = std::hypot(p.x(), p.y());
  if (r < 1e-12) return {lens.cu_px, lens.cv_px};
  const double scale = equidistant::rho(lens, std::atan2(r, p.z())) / r;
  return {lens.fu_px * scale * p.x() + lens.cu_px, lens.fv_px * scale * p.y() + lens.cv_px};
}

inline Projection project_with_derivatives(const Lens& lens, const Eigen::Vector3d& p) {
  Projection out;
  out.uv_px = project_equidistant(lens, p);
  out.by_lens.setZero();
  out.by_lens(0, 2) = 1.0;
  out.by_lens(1, 3) = 1.0;
  const double r2 = p.head<2>().squaredNorm();
  const double r = std::sqrt(r2);
  if (r < 1e-9) {
    out.by_point << lens.fu_px / p.z(), 0.0, 0.0, 0.0, lens.fv_px / p.z(), 0.0;
    return out;
  }
  const double theta = std::atan2(r, p.z());
  const double t2 = theta * theta;
  const double td = equidistant::rho(lens, theta);
  const double slope = equidistant::slope(lens, theta);
  const double n2 = r2 + p.z() * p.z();
  const Eigen::Vector2d e = p.head<2>() / r;
  const double along = slope * p.z() / n2;  // derivative of theta_d along the radius
  Eigen::Matrix<double, 2, 3> m_by_point;   // of theta_d e
  m_by_point.leftCols<2>() =
      along * e * e.transpose() + td / r * (Eigen::Matrix2d::Identity() - e * e.transpose());
  m_by_point.col(2) = -slope * r / n2 * e;
  const Eigen::Vector2d f(lens.fu_px, lens.fv_px);
  out.by_point = f.asDiagonal() * m_by_point;
  out.by_lens(0, 0) = td * e.x();
  out.by_lens(1, 1) = td * e.y();
  double power = theta;
  for (int i = 0; i < 4; ++i) {
    power *= t2;
    out.by_lens.col(4 + i) = power * f.cwiseProduct(e);
  }
  return out;
}

inline LensVector lens_vector(const Lens& lens) {
  LensVector v;
  v << lens.fu_px, lens.fv_px, lens.cu_px, lens.cv_px, lens.k[0], lens.k[1], lens.k[2], lens.k[3];
  return v;
}

inline Lens lens_of_vector(const LensVector& v, int width_px, int height_px) {
  return {width_px, height_px, v[0], v[1], v[2], v[3], {v[4], v[5], v[6], v[7]}};
}

inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace zenith::tools
