#pragma once
// Rows of one landmark over a few particles at random poses, and the same observation model and
// Kalman filter in plain Eigen and double: what the kernels are compared with.

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "platform/base/random.h"
#include "slam/filter/landmark.h"
#include "slam/geometry.h"

namespace zenith {

// Camera pose in the plane as floats hold it: the reference computes from the same numbers.
struct CameraPose {
  Eigen::Vector2d c = Eigen::Vector2d::Zero();
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity();
};

struct CameraRig {
  std::array<std::vector<float>, 4> values;

  explicit CameraRig(int particles) {
    for (auto& v : values) v.resize(static_cast<std::size_t>(row_stride(particles)));
  }
  void set(int i, const Pose2& pose) {
    const auto k = static_cast<std::size_t>(i);
    values[0][k] = static_cast<float>(pose.x_m);
    values[1][k] = static_cast<float>(pose.y_m);
    values[2][k] = static_cast<float>(std::cos(pose.theta_rad));
    values[3][k] = static_cast<float>(std::sin(pose.theta_rad));
  }
  CameraPose at(int i) const {
    const auto k = static_cast<std::size_t>(i);
    const double c = static_cast<double>(values[2][k]);
    const double s = static_cast<double>(values[3][k]);
    CameraPose pose;
    pose.c = {static_cast<double>(values[0][k]), static_cast<double>(values[1][k])};
    pose.R << c, -s, s, c;
    return pose;
  }
  CameraRows rows() {
    return {values[0].data(), values[1].data(), values[2].data(), values[3].data()};
  }
};

// The Gaussian over (ax, ay, rho).
struct LandmarkGaussian {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = Eigen::Matrix3d::Identity();
};

struct LandmarkRig {
  std::array<std::vector<float>, kLandmarkRows> values;
  CameraRig anchor;

  explicit LandmarkRig(int particles) : anchor(particles) {
    for (auto& v : values) v.resize(static_cast<std::size_t>(row_stride(particles)));
  }
  void set(int i, const LandmarkGaussian& g) {
    const Eigen::Matrix3d& P = g.P;
    const std::array<double, kLandmarkRows> all = {g.x[0],  g.x[1],  g.x[2],  P(0, 0), P(0, 1),
                                                   P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
    for (std::size_t r = 0; r < all.size(); ++r) {
      values[r][static_cast<std::size_t>(i)] = static_cast<float>(all[r]);
    }
  }
  LandmarkGaussian get(int i) const {
    std::array<double, kLandmarkRows> v;
    for (std::size_t r = 0; r < v.size(); ++r) {
      v[r] = static_cast<double>(values[r][static_cast<std::size_t>(i)]);
    }
    LandmarkGaussian g;
    g.x << v[0], v[1], v[2];
    g.P << v[3], v[4], v[5], v[4], v[6], v[7], v[5], v[7], v[8];
    return g;
  }
  LandmarkRows rows() {
    auto& v = values;
    const CameraRows a = anchor.rows();
    return {v[0].data(), v[1].data(), v[2].data(), v[3].data(), v[4].data(),
            v[5].data(), v[6].data(), v[7].data(), v[8].data(), a.x,
            a.y,         a.cos,       a.sin};
  }
};

// H of the landmark's header.
inline Eigen::Matrix<double, 2, 3> reference_h(const CameraPose& anchor, const CameraPose& camera) {
  Eigen::Matrix<double, 2, 3> H;
  H << camera.R.transpose() * anchor.R, camera.R.transpose() * (anchor.c - camera.c);
  return H;
}

// The textbook update with `k` stacked observations: residual z - H x of 2k rows.
template <typename Residual, typename Jacobian>
LandmarkGaussian reference_update(const LandmarkGaussian& prior, const Residual& z,
                                  const Jacobian& H, double noise) {
  const auto m = z.size();
  const Eigen::MatrixXd S = H * prior.P * H.transpose() + noise * Eigen::MatrixXd::Identity(m, m);
  const Eigen::MatrixXd K = prior.P * H.transpose() * S.inverse();
  LandmarkGaussian out;
  out.x = prior.x + K * (z - H * prior.x);
  const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - K * H;
  out.P = rest * prior.P * rest.transpose() + noise * K * K.transpose();
  return out;
}

// A random pose within `reach_m`, any heading.
inline Pose2 random_pose(Random& random, double reach_m) {
  const double x = random.uniform(-reach_m, reach_m);
  const double y = random.uniform(-reach_m, reach_m);
  return {x, y, random.uniform(-3.14, 3.14)};
}

// A random landmark with a proper covariance: sigmas of a few pixels and of some percent of rho.
inline LandmarkGaussian random_landmark(Random& random, double sigma_a, double sigma_rho) {
  LandmarkGaussian g;
  g.x = {random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2), random.uniform(0.25, 0.7)};
  Eigen::Matrix3d L = Eigen::Matrix3d::Identity();
  L(1, 0) = random.uniform(-0.6, 0.6);
  L(2, 0) = random.uniform(-0.6, 0.6);
  L(2, 1) = random.uniform(-0.6, 0.6);
  const Eigen::Vector3d sigma(sigma_a * random.uniform(0.5, 2.0),
                              sigma_a * random.uniform(0.5, 2.0),
                              sigma_rho * random.uniform(0.5, 2.0));
  g.P = sigma.asDiagonal() * L * L.transpose() * sigma.asDiagonal();
  return g;
}

}  // namespace zenith
