// Paper Eq. 2-3: the 2k residual of k robots in one update.

#include "slam/filter/landmark_stacked.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/landmark_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kParticles = 64;
constexpr float kNoise = 1.2e-4F;  // one pixel, as tangents squared

// A landmark, and robots that see it from poses of their own in every particle.
struct Scene {
  LandmarkRig landmark{kParticles};
  std::vector<CameraRig> cameras;
  std::vector<StackedObservation> observers;

  // The particles differ by centimetres and degrees, as those of a filter do.
  Scene(Random& random, int robots) {
    const LandmarkGaussian mark = random_landmark(random, 0.02, 0.1);
    scatter(random, landmark.anchor);
    for (int i = 0; i < kParticles; ++i) landmark.set(i, mark);
    for (int j = 0; j < robots; ++j) scatter(random, cameras.emplace_back(kParticles));
    for (CameraRig& camera : cameras) {
      const Eigen::Vector2d m =
          reference_h(landmark.anchor.at(0), camera.at(0)) * landmark.get(0).x;
      observers.push_back({camera.rows(), static_cast<float>(m.x() + 0.02 * random.normal()),
                           static_cast<float>(m.y() + 0.02 * random.normal()),
                           kNoise * static_cast<float>(random.uniform(0.5, 3.0))});
    }
  }

  static void scatter(Random& random, CameraRig& camera) {
    const Pose2 mean = random_pose(random, 1.0);
    for (int i = 0; i < kParticles; ++i) {
      const Pose2 off = random_pose(random, 0.03);
      camera.set(i, mean * Pose2{off.x_m, off.y_m, 0.01 * off.theta_rad});
    }
  }
};

// All in doubles, in information form: another way to the same posterior.
LandmarkGaussian in_information_form(const Scene& scene, int i, LandmarkGaussian prior) {
  Eigen::Matrix3d information = prior.P.inverse();
  Eigen::Vector3d vector = information * prior.x;
  for (std::size_t j = 0; j < scene.cameras.size(); ++j) {
    const auto H = reference_h(scene.landmark.anchor.at(i), scene.cameras[j].at(i));
    const StackedObservation& o = scene.observers[j];
    information += H.transpose() * H / static_cast<double>(o.noise);
    vector += H.transpose() * Eigen::Vector2d(o.zx, o.zy) / static_cast<double>(o.noise);
  }
  return {information.inverse() * vector, information.inverse()};
}

double state_error(const LandmarkGaussian& a, const LandmarkGaussian& b) {
  const Eigen::Vector3d sigma = b.P.diagonal().cwiseSqrt();
  return (a.x - b.x).cwiseQuotient(sigma).cwiseAbs().maxCoeff();
}

double covariance_error(const LandmarkGaussian& a, const LandmarkGaussian& b) {
  const Eigen::Vector3d inverse = b.P.diagonal().cwiseSqrt().cwiseInverse();
  return (inverse.asDiagonal() * (a.P - b.P) * inverse.asDiagonal()).cwiseAbs().maxCoeff();
}

class Stacked : public testing::TestWithParam<int> {};

// Tolerance: states are stored as floats, 24 bits of about 1, and sigmas are about 1e-2.
TEST_P(Stacked, IsTheExactPosterior) {
  const TestSeed seed;
  Random random(seed.value(), static_cast<std::uint64_t>(GetParam()));
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene(random, GetParam());
    std::vector<LandmarkGaussian> prior;
    for (int i = 0; i < kParticles; ++i) prior.push_back(scene.landmark.get(i));
    update_landmark_stacked(scene.landmark.rows(), scene.observers, kParticles);
    for (int i = 0; i < kParticles; ++i) {
      const auto expected = in_information_form(scene, i, prior[static_cast<std::size_t>(i)]);
      EXPECT_LT(state_error(scene.landmark.get(i), expected), 1e-3) << "particle " << i;
      EXPECT_LT(covariance_error(scene.landmark.get(i), expected), 1e-4) << "particle " << i;
    }
  }
}

// The single kernel computes in floats and cancels digits of P in each of its k updates.
TEST_P(Stacked, EqualsOneRobotAfterTheOther) {
  const TestSeed seed;
  Random random(seed.value(), static_cast<std::uint64_t>(GetParam()));
  Scene scene(random, GetParam());
  LandmarkRig sequential = scene.landmark;
  update_landmark_stacked(scene.landmark.rows(), scene.observers, kParticles);
  for (const StackedObservation& o : scene.observers) {
    update_landmark(sequential.rows(), o.camera, kParticles, o.zx, o.zy, o.noise);
  }
  for (int i = 0; i < kParticles; ++i) {
    EXPECT_LT(state_error(sequential.get(i), scene.landmark.get(i)), 0.02) << "particle " << i;
    EXPECT_LT(covariance_error(sequential.get(i), scene.landmark.get(i)), 0.02) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, Stacked, testing::Values(1, 2, 3, 5, kMaxObservers));

// "We can obtain a more accurate estimate [...] when we have larger number of k."
TEST(StackedUpdate, EveryFurtherRobotMakesTheLandmarkSharper) {
  const TestSeed seed;
  Random random(seed.value());
  Scene scene(random, kMaxObservers);
  std::vector<double> before(kParticles, 1e9);
  for (std::size_t k = 1; k <= scene.observers.size(); ++k) {
    LandmarkRig landmark = scene.landmark;
    update_landmark_stacked(landmark.rows(), std::span(scene.observers).first(k), kParticles);
    for (int i = 0; i < kParticles; ++i) {
      const double size = landmark.get(i).P.determinant();
      EXPECT_LT(size, before[static_cast<std::size_t>(i)]) << k << " robots";
      before[static_cast<std::size_t>(i)] = size;
    }
  }
}

// log N(e; 0, S) - sum_j log N(e_j; 0, S_jj), by the chain rule: what the second robot sees, given
// what the first one saw, against what it would see alone.
TEST(StackedUpdate, WeightsLearnWhatTheViewsHaveInCommon) {
  const TestSeed seed;
  Random random(seed.value());
  Scene scene(random, 2);
  LandmarkRig sequential = scene.landmark;
  std::vector<double> log_weight(kParticles, 0.0);
  update_landmark_stacked(scene.landmark.rows(), scene.observers, kParticles, log_weight.data());
  const auto log_likelihood = [&](std::size_t j) {
    std::vector<double> out(row_stride(kParticles), 0.0);
    const StackedObservation& o = scene.observers[j];
    add_log_likelihood(sequential.rows(), o.camera, kParticles, {o.zx, o.zy, o.noise}, 1e9F,
                       out.data());
    return out;
  };
  const auto alone = log_likelihood(1);
  const StackedObservation& first = scene.observers[0];
  update_landmark(sequential.rows(), first.camera, kParticles, first.zx, first.zy, first.noise);
  const auto given_first = log_likelihood(1);
  for (std::size_t i = 0; i < kParticles; ++i) {
    const double expected = given_first[i] - alone[i];
    EXPECT_NEAR(log_weight[i], expected, 0.01 + 0.01 * std::abs(expected)) << "particle " << i;
  }
}

}  // namespace
}  // namespace zenith
