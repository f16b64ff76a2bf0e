// Two Gaussians of one landmark, made from different anchors, as one.

#include "slam/filter/landmark_fusion.h"

#include <gtest/gtest.h>

#include "tests/support/landmark_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kParticles = 64;

// The same landmark, seen exactly from two anchors, in frames T apart.
struct Scene {
  LandmarkRig own{kParticles};
  LandmarkRig other{kParticles};
  std::vector<Pose2> T_own_other;
  std::vector<Eigen::Matrix3d> F;

  explicit Scene(Random& random, double off_sigma = 0.0) {
    for (int i = 0; i < kParticles; ++i) {
      const Pose2 T = random_pose(random, 3.0);
      const Pose2 anchor_in_other = random_pose(random, 1.0);
      own.anchor.set(i, random_pose(random, 1.0));
      other.anchor.set(i, anchor_in_other);
      CameraRig seen_from(kParticles);
      seen_from.set(i, T * anchor_in_other);
      Eigen::Matrix3d& to_other = F.emplace_back(Eigen::Matrix3d::Identity());
      to_other.topRows<2>() = reference_h(own.anchor.at(i), seen_from.at(i));
      const LandmarkGaussian a = random_landmark(random, 0.01, 0.05);
      LandmarkGaussian b = random_landmark(random, 0.01, 0.05);
      b.x = to_other * a.x;
      b.x.x() += off_sigma * std::sqrt(b.P(0, 0));
      own.set(i, a);
      other.set(i, b);
      T_own_other.push_back(T);
    }
  }
};

TEST(LandmarkFusion, AgreesWithTheSumOfInformation) {
  const TestSeed seed;
  Random random(seed.value());
  Scene scene(random);
  const LandmarkRig before = scene.own;
  fuse_landmark(scene.own.rows(), scene.other.rows(), scene.T_own_other);
  for (int i = 0; i < kParticles; ++i) {
    const LandmarkGaussian a = before.get(i);
    const LandmarkGaussian b = scene.other.get(i);
    const LandmarkGaussian fused = scene.own.get(i);
    const Eigen::Matrix3d& F = scene.F[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d P = (a.P.inverse() + F.transpose() * b.P.inverse() * F).inverse();
    const Eigen::Vector3d inverse = P.diagonal().cwiseSqrt().cwiseInverse();
    EXPECT_LT((inverse.asDiagonal() * (fused.P - P) * inverse.asDiagonal()).norm(), 1e-3);
    // They were the same place but for floats' rounding, so it stays.
    EXPECT_LT((fused.x - a.x).cwiseProduct(inverse).norm(), 1e-2) << "particle " << i;
  }
}

TEST(LandmarkFusion, DisagreementMakesTheCovarianceLarger) {
  const TestSeed seed;
  Random one(seed.value());
  Random two(seed.value());
  Scene agreed(one);
  Scene apart(two, 100.0);
  fuse_landmark(agreed.own.rows(), agreed.other.rows(), agreed.T_own_other);
  fuse_landmark(apart.own.rows(), apart.other.rows(), apart.T_own_other);
  double ratio = 0.0;
  for (int i = 0; i < kParticles; ++i) {
    const double trace = apart.own.get(i).P.trace();
    EXPECT_GE(trace, agreed.own.get(i).P.trace()) << "particle " << i;
    ratio += trace / agreed.own.get(i).P.trace() / kParticles;
  }
  EXPECT_GT(ratio, 2.0);
}

}  // namespace
}  // namespace zenith
