// The optimal proposal against numbers: Jacobian by differences, normal equations and weights in
// plain Eigen with stacked residuals.

#include "slam/filter/proposal.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/support/arena_block.h"
#include "tests/support/landmark_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr double kNoise = 1.2e-4;
constexpr double kRho = 0.43;
const Eigen::Vector2d kLever(0.12, -0.07);

CameraPose camera_of(const Pose2& robot) {
  return {robot * kLever, rotation(robot.theta_rad)};
}

// One landmark seen by one robot, in double, from a pose that can be moved.
struct Sight {
  CameraPose anchor;
  LandmarkGaussian landmark;
  Eigen::Vector2d z = Eigen::Vector2d::Zero();

  Eigen::Vector2d m(const Pose2& robot) const {
    return reference_h(anchor, camera_of(robot)) * landmark.x;
  }
  // d z / d (forward, left, turn), by central differences.
  Eigen::Matrix<double, 2, 3> G(const Pose2& robot) const {
    constexpr double kStep = 1e-6;
    Eigen::Matrix<double, 2, 3> out;
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3d e = kStep * Eigen::Vector3d::Unit(i);
      out.col(i) = (m(robot * Pose2{e[0], e[1], e[2]}) - m(robot * Pose2{-e[0], -e[1], -e[2]})) /
                   (2.0 * kStep);
    }
    return out;
  }
  Eigen::Matrix2d S(const Pose2& robot) const {
    const auto H = reference_h(anchor, camera_of(robot));
    return H * landmark.P * H.transpose() + kNoise * Eigen::Matrix2d::Identity();
  }
};

// Three landmarks over the same particles; every particle has its own pose and landmarks.
struct Scene {
  static constexpr int kParticles = 150;  // more than two of the kernel's chunks
  static constexpr int kLandmarks = 3;
  Particles particles;
  ProposalRows rows;
  ArenaBlock block{[this](Arena& arena) {
    particles.layout(arena, kParticles);
    rows.layout(arena, kParticles);
  }};
  std::vector<LandmarkRig> landmarks{kLandmarks, LandmarkRig(kParticles)};
  std::vector<Eigen::Vector2f> z;

  // The landmarks have an error in common by `shared`.
  explicit Scene(Random& random, float shared = 0.0F) {
    for (int i = 0; i < kParticles; ++i) {
      particles.set_pose(i, random_pose(random, 0.5));
      for (LandmarkRig& l : landmarks) {
        l.anchor.set(i, random_pose(random, 0.5));
        LandmarkGaussian g = random_landmark(random, 0.01, 0.03);
        g.x.z() = kRho;
        l.set(i, g);
      }
    }
    place_cameras(particles, kLever);
    for (int k = 0; k < kLandmarks; ++k) {
      const Eigen::Vector2d near = sight(k, 0).m(particles.pose(0));
      z.emplace_back(static_cast<float>(near.x() + 0.01), static_cast<float>(near.y() - 0.02));
    }
    rows.clear(kParticles);
    for (int k = 0; k < kLandmarks; ++k) {
      const auto i = static_cast<std::size_t>(k);
      add_to_proposal(landmarks[i].rows(), particles.camera, kParticles, kLever.cast<float>(),
                      {z[i].x(), z[i].y(), static_cast<float>(kNoise), shared},
                      static_cast<float>(kRho), rows);
    }
    if (shared != 0.0F) marginalise_shared(kParticles, rows);
  }
  Sight sight(int k, int particle) const {
    const LandmarkRig& l = landmarks[static_cast<std::size_t>(k)];
    Sight s = {l.anchor.at(particle), l.get(particle), Eigen::Vector2d::Zero()};
    if (static_cast<std::size_t>(k) < z.size()) s.z = z[static_cast<std::size_t>(k)].cast<double>();
    return s;
  }
};

TEST(Proposal, NormalEquationsAgreeWithNumericJacobians) {
  const TestSeed seed;
  Random random(seed.value());
  Scene scene(random);
  for (int i = 0; i < Scene::kParticles; ++i) {
    Eigen::Matrix3d lambda = Eigen::Matrix3d::Zero();
    Eigen::Vector3d eta = Eigen::Vector3d::Zero();
    double squares = 0.0;
    double log_det = 0.0;
    const Pose2 pose = scene.particles.pose(i);
    for (int k = 0; k < Scene::kLandmarks; ++k) {
      const Sight s = scene.sight(k, i);
      const auto G = s.G(pose);
      const Eigen::Matrix2d W = s.S(pose).inverse();
      const Eigen::Vector2d nu = s.z - s.m(pose);
      lambda += G.transpose() * W * G;
      eta += G.transpose() * W * nu;
      squares += nu.dot(W * nu);
      log_det += std::log(s.S(pose).determinant());
    }
    const auto row = [&](int r) { return static_cast<double>(scene.rows.row[r][i]); };
    Eigen::Matrix3d got;
    got << row(0), row(1), row(2), row(1), row(3), row(4), row(2), row(4), row(5);
    ASSERT_LT((got - lambda).norm(), 1e-4 * lambda.norm()) << "particle " << i;
    ASSERT_LT((Eigen::Vector3d(row(6), row(7), row(8)) - eta).norm(), 1e-4 * eta.norm());
    ASSERT_NEAR(row(9), squares, 1e-4 * squares);
    ASSERT_NEAR(row(10), log_det, 1e-3);
  }
}

// The weight is the likelihood of all residuals at once with the pose integrated out: a Gaussian of
// 2k rows with covariance G Q G^T + diag(S) + u u^T, u what the landmarks have in common.
void expect_marginal_likelihood(Random& random, double shared) {
  Scene scene(random, static_cast<float>(shared));
  MotionIncrement motion;
  motion.covariance = Eigen::Vector3d(1e-4, 4e-5, 9e-5).asDiagonal();
  std::vector<Pose2> before;
  for (int i = 0; i < Scene::kParticles; ++i) {
    before.push_back(scene.particles.pose(i));
    scene.particles.log_weight[static_cast<std::size_t>(i)] = 0.5;
  }
  draw_from_proposal(scene.particles, motion.covariance, scene.rows, random);
  constexpr int kRows = 2 * Scene::kLandmarks;
  for (int i = 0; i < Scene::kParticles; ++i) {
    const Pose2 pose = before[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, kRows, 3> G;
    Eigen::Matrix<double, kRows, kRows> S = Eigen::Matrix<double, kRows, kRows>::Zero();
    Eigen::Matrix<double, kRows, 1> nu;
    Eigen::Matrix<double, kRows, 1> u;
    for (int k = 0; k < Scene::kLandmarks; ++k) {
      const Sight s = scene.sight(k, i);
      G.middleRows<2>(2 * k) = s.G(pose);
      S.block<2, 2>(2 * k, 2 * k) = s.S(pose);
      nu.segment<2>(2 * k) = s.z - s.m(pose);
      u.segment<2>(2 * k) =
          shared * depth_covariance(scene.landmarks[static_cast<std::size_t>(k)].rows(),
                                    scene.particles.camera, i);
    }
    S += u * u.transpose() + G * motion.covariance * G.transpose();
    const double expected = 0.5 - 0.5 * (nu.dot(S.inverse() * nu) + std::log(S.determinant()));
    const double got = scene.particles.log_weight[static_cast<std::size_t>(i)];
    ASSERT_NEAR(got, expected, 1e-3 * (1.0 + std::abs(expected))) << "particle " << i;
  }
}

TEST(Proposal, WeightIsTheMarginalLikelihood) {
  const TestSeed seed;
  Random random(seed.value());
  expect_marginal_likelihood(random, 0.0);
  expect_marginal_likelihood(random, 5.0);
  expect_marginal_likelihood(random, 500.0);
}

// 20 000 particles in one pose with one landmark each: the drawn motions have mean Lambda^-1 eta
// and covariance Lambda^-1. Deviations as in the motion model's test, five of them.
TEST(Proposal, DrawsFromThePosterior) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kSamples = 20'000;
  Particles particles;
  ProposalRows rows;
  const ArenaBlock block([&](Arena& arena) {
    particles.layout(arena, kSamples);
    rows.layout(arena, kSamples);
  });
  LandmarkRig landmark(kSamples);
  const LandmarkGaussian g = random_landmark(random, 0.01, 0.02);
  const Pose2 pose = {0.4, -0.2, 0.7};
  for (int i = 0; i < kSamples; ++i) {
    particles.set_pose(i, pose);
    landmark.anchor.set(i, {0.1, 0.1, -0.3});
    landmark.set(i, g);
  }
  place_cameras(particles, kLever);
  Sight s = {landmark.anchor.at(0), landmark.get(0), Eigen::Vector2d::Zero()};
  s.z = (s.m(pose) + Eigen::Vector2d(0.01, -0.015)).cast<float>().cast<double>();
  rows.clear(kSamples);
  add_to_proposal(
      landmark.rows(), particles.camera, kSamples, kLever.cast<float>(),
      {static_cast<float>(s.z.x()), static_cast<float>(s.z.y()), static_cast<float>(kNoise)},
      static_cast<float>(g.x.z()), rows);
  MotionIncrement motion;
  motion.covariance = Eigen::Vector3d(1e-3, 4e-4, 1e-3).asDiagonal();
  const auto G = s.G(pose);
  const Eigen::Matrix2d W = s.S(pose).inverse();
  const Eigen::Matrix3d expected =
      (motion.covariance.inverse().eval() + G.transpose() * W * G).inverse();
  const Eigen::Vector3d expected_mean = expected * (G.transpose() * W * (s.z - s.m(pose)));
  draw_from_proposal(particles, motion.covariance, rows, random);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Pose2 moved = pose.inverse() * particles.pose(i);
    const Eigen::Vector3d d =
        Eigen::Vector3d(moved.x_m, moved.y_m, wrap_angle(moved.theta_rad)) - expected_mean;
    mean += d / kSamples;
    second += d * d.transpose() / kSamples;
  }
  const double root = std::sqrt(static_cast<double>(kSamples));
  for (int i = 0; i < 3; ++i) {
    const double sigma_i = std::sqrt(expected(i, i));
    EXPECT_NEAR(mean[i], 0.0, 5.0 * sigma_i / root) << i;
    for (int k = 0; k <= i; ++k) {
      const double tolerance = 5.0 * 1.4143 * sigma_i * std::sqrt(expected(k, k)) / root;
      EXPECT_NEAR(second(i, k), expected(i, k), tolerance) << i << ' ' << k;
    }
  }
}

TEST(Proposal, WithoutLandmarksItIsTheOdometry) {
  Particles particles;
  ProposalRows rows;
  constexpr int kSamples = 10'000;
  const ArenaBlock block([&](Arena& arena) {
    particles.layout(arena, kSamples);
    rows.layout(arena, kSamples);
  });
  const TestSeed seed;
  Random random(seed.value());
  MotionIncrement motion;
  motion.covariance = Eigen::Vector3d(1e-4, 1e-6, 1e-4).asDiagonal();
  rows.clear(kSamples);
  draw_from_proposal(particles, motion.covariance, rows, random);
  double second = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    second += particles.theta_rad[i] * particles.theta_rad[i] / kSamples;
    ASSERT_NEAR(particles.log_weight[i], 0.0, 1e-9);
  }
  // Of 10 000 samples a variance is known to 1.4 %; five of those.
  EXPECT_NEAR(second / 1e-4, 1.0, 0.07);
}

}  // namespace
}  // namespace zenith
