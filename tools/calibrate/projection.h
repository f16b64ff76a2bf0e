#pragma once
// The fisheye projection of slam/image/lens.h with its derivatives.

#include <Eigen/Core>

#include "slam/image/lens.h"

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

// Of a point in the camera frame.
inline Projection project_with_derivatives(const Lens& lens, const Eigen::Vector3d& p) {
  Projection out;
  out.uv_px = lens.project(p);
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
  const auto& k = lens.k;
  const double td = lens.distort(theta);
  const double slope =
      1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
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
