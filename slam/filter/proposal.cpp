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

void move_by_mean(Particles& particles, const Pose2& mean) {
  const Eigen::Vector3d xi(mean.x_m, mean.y_m, mean.theta_rad);
  for (int i = 0; i < particles.count; ++i) move(particles, i, xi);
}

void draw_from_motion(Particles& particles, const Eigen::Matrix3d& covariance, Random& random) {
  if (covariance.isZero(0.0)) return;
  const Eigen::Matrix3d L =
      (covariance + kMinVariance * Eigen::Matrix3d::Identity()).llt().matrixL();
  for (int i = 0; i < particles.count; ++i) move(particles, i, L * normal3(random));
}

void ProposalRows::layout(Arena& arena, int particles) {
  for (float*& r : row)
    r = arena.take<float>(static_cast<std::size_t>(row_stride(particles))).data();
}

void ProposalRows::clear(int particles) {
  for (float* r : row) std::fill(r, r + particles, 0.0F);
}

void add_to_proposal(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                     const Eigen::Vector2f& lever_m, const Sight& sight, float rho,
                     const ProposalRows& rows) {
  rows_in_use().add_to_proposal(landmark, camera, particles, lever_m.x(), lever_m.y(), sight, rho,
                                rows.row);
}

void marginalise_shared(int particles, const ProposalRows& rows) {
  rows_in_use().marginalise_shared(particles, rows.row);
}

void draw_from_proposal(Particles& particles, const Eigen::Matrix3d& covariance,
                        const ProposalRows& rows, Random& random) {
  const Eigen::Matrix3d Q = covariance + kMinVariance * Eigen::Matrix3d::Identity();
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
