#pragma once
// The anchored landmark, exactly linear for a given particle (paper-notes; paper Eq. 1).
//
//   state    (ax, ay, rho): where the landmark was seen from its anchor, as tangents, and the
//            inverse of its height above the camera
//   predict  m = R(theta_a - theta_t) (ax, ay) + rho b,   b = R(theta_t)^T (c_a - c_t)
//   observe  z = m + noise,   H = [R(theta_a - theta_t) | b],   S = H P H^T + sigma^2 I
//   place    L_xy = c_a + R(theta_a) (ax, ay) / rho,   L_z = z_camera + 1 / rho
//
// c is the camera centre in the plane, theta the heading, a the anchor, t the time of observation;
// m and z are tangents in the level image (Pinhole::normalise). Both poses are known numbers for a
// particle, so the Kalman update is exact, also with almost no parallax, where an EKF on
// (Lx, Ly, Lz) linearises badly.
//
// Every function here works on rows of particles, with the kernels of slam/kernels/rows; the caller
// has brought all rows to the same generation. Rows and weights are padded (row_stride()).

#include <Eigen/Core>

#include "slam/filter/particles.h"
#include "slam/filter/rows.h"
#include "slam/kernels/rows/rows.h"

namespace zenith {

// Least inverse height that is turned into metres: 100 m above the camera.
inline constexpr double kLeastRho = 0.01;

inline constexpr int kLandmarkRows = 9;  // ax ay rho | Pxx Pxy Pxr Pyy Pyr Prr
inline constexpr int kAnchorRows = 4;    // x y cos sin

using LandmarkRowStore = RowStore<kLandmarkRows>;
using AnchorRowStore = RowStore<kAnchorRows>;

LandmarkRows landmark_rows(LandmarkRowStore& landmarks, int slot, AnchorRowStore& anchors,
                           int anchor);

// For each particle: m, and S without the measurement noise.
void predict_landmark(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                      const PredictionRows& out);

// Over all particles: the mean of m, its spread between particles, the mean of S, the mean of rho.
struct LandmarkPrediction {
  Eigen::Vector2d mean;
  Eigen::Matrix2d spread;
  Eigen::Matrix2d own;
  double rho = 0.0;
};
LandmarkPrediction predict_landmark(const LandmarkRows& landmark, const CameraRows& camera,
                                    const double* weight, int particles);

// (P H^T)_rho of one particle: how the predicted m and rho vary together.
Eigen::Vector2d depth_covariance(const LandmarkRows& landmark, const CameraRows& camera,
                                 int particle);

// The Kalman update with observation (zx, zy) of variance `noise` on each axis.
void update_landmark(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                     float zx, float zy, float noise);

// log N(z; m, S) summed into log_likelihood, each landmark's squared Mahalanobis distance capped:
// a wrong match then costs every particle the same at most. S holds what `sight` shares.
void add_log_likelihood(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                        const Sight& sight, float cap, double* log_likelihood);

// The start: seen at (zx, zy) with variance `noise`, nothing known of the height but
// rho ~ N(rho_mean, rho_sigma^2).
void start_landmark(const LandmarkRows& landmark, int particles, float zx, float zy, float noise,
                    float rho_mean, float rho_sigma);

// Mean and covariance over all particles of the landmark's place (paper's L), camera height
// `camera_z_m`; also the weighted mean and variance of rho.
struct LandmarkPlace {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  double rho = 0.0;
  double rho_variance = 0.0;
};
LandmarkPlace place_landmark(const LandmarkRows& landmark, const double* weight, int particles,
                             double camera_z_m);

}  // namespace zenith
