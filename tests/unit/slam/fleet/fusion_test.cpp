// The common map: Gaussians as they must combine, and each landmark once.

#include "slam/fleet/fusion.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/own_map.h"

namespace zenith {
namespace {

using point_world::OwnMapRig;
using point_world::PointWorld;

Eigen::Matrix3d random_covariance(Random& random) {
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < i; ++k) L(i, k) = 0.05 * random.uniform(-1.0, 1.0);
    L(i, i) = random.uniform(0.02, 0.2);
  }
  return L * L.transpose();
}

Eigen::Vector3d random_point(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

// Independent observations: robots with information I_1 and I_2 on top of nothing, fused, equal one
// least-squares update with all rows stacked (Eq. 3).
TEST(Fusion, EqualsTheStackedUpdate) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<LandmarkEstimate> robots(3);
    Eigen::Matrix<double, 9, 3> H;
    Eigen::Matrix<double, 9, 9> W = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> z;
    for (int k = 0; k < 3; ++k) {
      LandmarkEstimate& e = robots[static_cast<std::size_t>(k)];
      e.position_m = random_point(random);
      e.covariance_m2 = random_covariance(random);
      e.observations = 4;
      H.middleRows<3>(3 * k).setIdentity();
      W.block<3, 3>(3 * k, 3 * k) = e.covariance_m2.inverse();
      z.segment<3>(3 * k) = e.position_m;
    }
    const Eigen::Matrix3d P = (H.transpose() * W * H).inverse();
    const Eigen::Vector3d x = P * H.transpose() * W * z;
    const LandmarkEstimate got = fuse(fuse(robots[0], robots[1]), robots[2]);
    ASSERT_LT((got.position_m - x).norm(), 1e-3) << "trial " << trial;
    ASSERT_LT((got.covariance_m2 - P).norm(), 1e-3 * P.norm()) << "trial " << trial;
    ASSERT_EQ(got.observations, 12);
    const LandmarkEstimate other = fuse(robots[2], fuse(robots[1], robots[0]));
    ASSERT_LT((other.position_m - got.position_m).norm(), 1e-3) << "the order must not matter";
  }
}

TEST(Fusion, TransformMovesPlaceAndCovariance) {
  const TestSeed seed;
  Random random(seed.value());
  point_world::PointLandmark l;
  l.p_m = {2.0, 1.0, 2.5};
  point_world::PeerRig rig;
  LandmarkRecord r = record_of(l, 1, 1, {});
  r.covariance_m2 = {0.01F, 0.002F, 0.001F, 0.02F, 0.003F, 0.04F};
  rig.map.apply(r);
  const Pose2 T = {5.0, -1.0, 0.8};
  const Eigen::Matrix3d P_T = random_covariance(random);
  const LandmarkEstimate got = transform_landmark(rig.map[0], T, P_T);
  EXPECT_LT((got.position_m.head<2>() - T * Eigen::Vector2d(2.0, 1.0)).norm(), 1e-6);
  EXPECT_NEAR(got.position_m.z(), 2.5, 1e-6);
  const Eigen::Matrix2d plane =
      transform_covariance(T, P_T, {2.0, 1.0}, rig.map[0].covariance_xy());
  EXPECT_LT((got.covariance_m2.topLeftCorner<2, 2>() - plane).norm(), 1e-9);
  EXPECT_NEAR(got.covariance_m2(2, 2), 0.04, 1e-8);
  EXPECT_LT((got.covariance_m2 - got.covariance_m2.transpose()).norm(), 1e-12);
}

// Landmarks half a metre apart and more, so that none can be taken for another.
PointWorld sparse_world(Random& random, std::size_t count) {
  PointWorld world;
  while (world.landmarks.size() < count) {
    const auto next = PointWorld::scatter(random, 1, -5.0, 5.0, -5.0, 5.0).landmarks[0];
    const bool free =
        std::all_of(world.landmarks.begin(), world.landmarks.end(),
                    [&next](const auto& l) { return (l.p_m - next.p_m).head(2).norm() > 0.5; });
    if (free) world.landmarks.push_back(next);
  }
  return world;
}

// Own landmarks 0..59, the peer's 30..89: 30 in common.
struct Scene {
  Random random;
  PointWorld world;
  OwnMapRig own;
  Fleet fleet;
  ArenaBlock block{[this](Arena& arena) { fleet.layout(arena); }};
  Pose2 T_peer_world = {3.0, -2.0, 1.1};
  double driven_m = 10.0;
  std::array<FusedLandmark, 256> out;

  explicit Scene(std::uint64_t seed) : random(seed), world(sparse_world(random, 90)) {
    fleet.build({});
    for (std::size_t i = 0; i < 60; ++i) own.add(world.landmarks[i]);
    for (std::size_t i = 30; i < 90; ++i) {
      const LandmarkRecord r =
          record_of(world.landmarks[i], static_cast<std::uint32_t>(i) + 1000, 1, T_peer_world);
      fleet.receive(2, {&r, 1});
    }
  }
  bool merged() const {
    return !fleet.alignments().empty() && fleet.alignments()[0].state == AlignmentState::kMerged;
  }
  void offer(const Pose2& T_own_peer) {
    fleet.update(ObservedFrame{}, own.map, Pose2{}, driven_m);
    fleet.offer_alignment(2, T_own_peer);
    for (int i = 0; i < 20; ++i) fleet.rest(own.map);
  }
};

// A small map cannot show yet that it repeats itself: before 5 m of way even the truth is not
// believed.
TEST(Fusion, NoMergeAfterAShortWay) {
  const TestSeed seed;
  const auto scene = std::make_unique<Scene>(seed.value());
  scene->driven_m = 3.0;
  scene->offer(scene->T_peer_world.inverse());
  EXPECT_FALSE(scene->merged());
}

TEST(Fusion, WithoutAMergeTheMapIsOnesOwn) {
  const TestSeed seed;
  const auto scene = std::make_unique<Scene>(seed.value());
  EXPECT_EQ(read_common_map(scene->own.map, scene->fleet, scene->out), 60U);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(scene->out[i].owners, 1);
    EXPECT_EQ(scene->out[i].source, -1);
  }
}

TEST(Fusion, CommonLandmarksAreThereOnce) {
  const TestSeed seed;
  const auto scene = std::make_unique<Scene>(seed.value());
  scene->offer(scene->T_peer_world.inverse());
  ASSERT_TRUE(scene->merged());
  const std::size_t count = read_common_map(scene->own.map, scene->fleet, scene->out);
  EXPECT_EQ(count, 90U);
  int common = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const FusedLandmark& f = scene->out[i];
    common += f.owners == 2 ? 1 : 0;
    if (f.owners == 2) {
      EXPECT_LT(f.landmark.covariance_m2(2, 2), 0.6 * 0.02 * 0.02);
      EXPECT_EQ(f.landmark.observations, 20);
    }
    double nearest = 1e9;
    for (const auto& l : scene->world.landmarks) {
      nearest = std::min(nearest, (l.p_m - f.landmark.position_m).norm());
    }
    EXPECT_LT(nearest, 0.02);
  }
  EXPECT_EQ(common, 30);
  // Reading writes nothing into the own map.
  EXPECT_EQ(scene->own.map.info(40).observations, 10);
  EXPECT_EQ(read_common_map(scene->own.map, scene->fleet, std::span(scene->out).first(70)), 70U);
}

TEST(Fusion, AWrongOfferIsNotBelieved) {
  const TestSeed seed;
  for (const Pose2& wrong : {Pose2{1.0, 0.0, 0.0}, Pose2{0.0, 0.0, 0.5}, Pose2{-0.6, 0.7, 2.0}}) {
    const auto scene = std::make_unique<Scene>(seed.value());
    scene->offer(wrong * scene->T_peer_world.inverse());
    EXPECT_FALSE(scene->merged());
    EXPECT_EQ(read_common_map(scene->own.map, scene->fleet, scene->out), 60U);
  }
}

}  // namespace
}  // namespace zenith
