#include "slam/filter/proposal.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace zenith {
namespace {

// Variance below which the odometry is not believed in any direction: 20 um, 20 urad.
constexpr double kMinVariance = 4e-10;

Eigen::Vector3d normal3(Random& random) {
  const double a = random.normal();
  const double b = random.normal();
  const double c = random.normal();
  return {a, b, c};
}

void move(Particles& particles, int i, const Eigen::Vector3d& xi) {
  particles.set_pose(i, particles.pose(i) * Pose2{xi.x(), xi.y(), xi.z()});
}

}  // namespace

MotionIncrement motion_increment(const Wheels& wheels, const WheelTravel& travel,
                                 const MotionNoise& noise) {
  MotionIncrement out;
  out.mean = wheel_motion(wheels, travel);
  const double way = 0.5 * (std::abs(travel.left_m) + std::abs(travel.right_m));
  if (way == 0.0) return out;
  const auto square = [](double x) { return x * x; };
  const double b = wheels.track_width_m;
  out.covariance(0, 0) = square(noise.distance_per_sqrt_m) * way + 0.5 * square(noise.floor_m);
  out.covariance(1, 1) = square(noise.lateral_per_sqrt_m) * way;
  out.covariance(2, 2) = square(noise.turn_per_sqrt_m) * way + 2.0 * square(noise.floor_m / b);
  return out;
}

void move_by_mean(Particles& particles, const MotionIncrement& motion) {
  const Eigen::Vector3d xi(motion.mean.x_m, motion.mean.y_m, motion.mean.theta_rad);
  for (int i = 0; i < particles.count; ++i) move(particles, i, xi);
}

void move_by_sample(Particles& particles, const MotionIncrement& motion, Random& random) {
  const Eigen::Vector3d mean(motion.mean.x_m, motion.mean.y_m, motion.mean.theta_rad);
  const Eigen::Matrix3d L =
      (motion.covariance + kMinVariance * Eigen::Matrix3d::Identity()).llt().matrixL();
  const bool still = motion.covariance.isZero(0.0);
  for (int i = 0; i < particles.count; ++i) {
    const Eigen::Vector3d noise = L * normal3(random);
    move(particles, i, still ? mean : Eigen::Vector3d(mean + noise));
  }
}

void ProposalRows::layout(Arena& arena, int particles) {
  for (float*& r : row)
    r = arena.take<float>(static_cast<std::size_t>(row_stride(particles))).data();
}

void ProposalRows::clear(int particles) {
  for (float* r : row) std::fill(r, r + particles, 0.0F);
}

void add_to_proposal(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                     const Eigen::Vector2f& lever_m, float zx, float zy, float noise,
                     const ProposalRows& rows) {
  constexpr int kChunk = 64;  // predictions of so many particles stay in registers and L1
  float mx[kChunk];
  float my[kChunk];
  float sxx[kChunk];
  float sxy[kChunk];
  float syy[kChunk];
  for (int start = 0; start < particles; start += kChunk) {
    const int n = std::min(kChunk, particles - start);
    const LandmarkRows l = {
        landmark.ax + start,        landmark.ay + start,       landmark.rho + start,
        landmark.pxx + start,       landmark.pxy + start,      landmark.pxr + start,
        landmark.pyy + start,       landmark.pyr + start,      landmark.prr + start,
        landmark.anchor_x + start,  landmark.anchor_y + start, landmark.anchor_cos + start,
        landmark.anchor_sin + start};
    const CameraRows c = {camera.x + start, camera.y + start, camera.cos + start,
                          camera.sin + start};
    predict_landmark(l, c, n, {mx, my, sxx, sxy, syy});
    for (int i = 0; i < n; ++i) {
      const float a = sxx[i] + noise;
      const float b = sxy[i];
      const float d = syy[i] + noise;
      const float det = a * d - b * b;
      const float wxx = d / det;
      const float wxy = -b / det;
      const float wyy = a / det;
      const float rho = l.rho[i];
      const float gx = my[i] + rho * lever_m.y();
      const float gy = -(mx[i] + rho * lever_m.x());
      const float nx = zx - mx[i];
      const float ny = zy - my[i];
      const float ex = wxx * nx + wxy * ny;
      const float ey = wxy * nx + wyy * ny;
      const float tx = wxx * gx + wxy * gy;
      const float ty = wxy * gx + wyy * gy;
      const int k = start + i;
      rows.row[0][k] += rho * rho * wxx;
      rows.row[1][k] += rho * rho * wxy;
      rows.row[2][k] -= rho * tx;
      rows.row[3][k] += rho * rho * wyy;
      rows.row[4][k] -= rho * ty;
      rows.row[5][k] += gx * tx + gy * ty;
      rows.row[6][k] -= rho * ex;
      rows.row[7][k] -= rho * ey;
      rows.row[8][k] += gx * ex + gy * ey;
      rows.row[9][k] += nx * ex + ny * ey;
      rows.row[10][k] += std::log(det);
    }
  }
}

void draw_from_proposal(Particles& particles, const MotionIncrement& motion,
                        const ProposalRows& rows, Random& random) {
  const Eigen::Matrix3d Q = motion.covariance + kMinVariance * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d prior = Q.llt().solve(Eigen::Matrix3d::Identity());
  const double log_det_prior = std::log(prior.determinant());
  for (int i = 0; i < particles.count; ++i) {
    Eigen::Matrix3d lambda;
    lambda << rows.row[0][i], rows.row[1][i], rows.row[2][i], rows.row[1][i], rows.row[3][i],
        rows.row[4][i], rows.row[2][i], rows.row[4][i], rows.row[5][i];
    lambda += prior;
    const Eigen::Vector3d eta(rows.row[6][i], rows.row[7][i], rows.row[8][i]);
    const Eigen::LLT<Eigen::Matrix3d> llt(lambda);
    const Eigen::Vector3d mean = llt.solve(eta);
    // lambda = L L^T, so L^-T n has covariance lambda^-1.
    const Eigen::Matrix3d L = llt.matrixL();
    const Eigen::Vector3d noise =
        L.transpose().triangularView<Eigen::Upper>().solve(normal3(random));
    move(particles, i, mean + noise);
    const double log_det = 2.0 * (std::log(L(0, 0)) + std::log(L(1, 1)) + std::log(L(2, 2)));
    const auto k = static_cast<std::size_t>(i);
    particles.log_weight[k] +=
        0.5 * (eta.dot(mean) - static_cast<double>(rows.row[9][i]) -
               static_cast<double>(rows.row[10][i]) - log_det + log_det_prior);
  }
}

}  // namespace zenith
