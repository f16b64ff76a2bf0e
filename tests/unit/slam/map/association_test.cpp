#include "slam/map/association.h"

#include <memory>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr double kSigma = 0.005;  // half a pixel, in tangents
constexpr int kParticles = 4;

// Landmarks that are predicted, and a frame that shows them from a pose off by `xi`.
struct Scene {
  Map map;
  Associator associator;
  Particles particles;
  ArenaBlock block{[this](Arena& arena) {
    map.layout(arena, kParticles);
    associator.layout(arena);
    particles.layout(arena, kParticles);
  }};
  std::vector<Candidate> candidates;
  std::vector<Feature> features;
  std::array<bool, kMaxCorners> used = {};
  AssociationSettings settings;

  Scene() { map.reset(); }

  void add(const Eigen::Vector2d& m, const Patch& patch, const Eigen::Vector3d& xi,
           Random& random) {
    const int anchor = map.create_anchor(particles.camera, PoseSensitivity::Zero());
    Candidate c;
    c.slot = map.create(anchor);
    map.add_appearance(c.slot, patch, compact(patch), 0.0F);
    c.promoted = true;
    c.m = m;
    c.own = kSigma * kSigma * Eigen::Matrix2d::Identity();
    c.common = 1e-4 * Eigen::Matrix2d::Identity();
    c.G << -0.4, 0.0, m.y(), 0.0, -0.4, -m.x();
    candidates.push_back(c);
    const Eigen::Vector2d z = m + c.G * xi;
    Feature f;
    f.zx = static_cast<float>(z.x() + kSigma * random.normal());
    f.zy = static_cast<float>(z.y() + kSigma * random.normal());
    f.described = true;
    f.patch = patch;
    features.push_back(f);
  }
  void match(CandidateKind kind) {
    associator.match(candidates, kind, {}, 4.0, features, map, 0.0, settings, used);
  }
};

std::unique_ptr<Scene> spread_scene(Random& random, int count, const Eigen::Vector3d& xi) {
  auto scene = std::make_unique<Scene>();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d m(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    scene->add(m, point_world::random_patch(random), xi, random);
  }
  return scene;
}

constexpr auto kRecent = CandidateKind::kPromotedRecent;

TEST(Association, EachLandmarkFindsItsCorner) {
  const TestSeed seed;
  Random random(seed.value());
  const auto scene = spread_scene(random, 60, {0.01, -0.01, 0.005});
  scene->match(kRecent);
  for (std::size_t i = 0; i < scene->candidates.size(); ++i) {
    EXPECT_EQ(scene->candidates[i].corner, static_cast<int>(i));
    EXPECT_TRUE(scene->used[i]);
  }
}

TEST(Association, OneCornerServesOneLandmark) {
  Random random(1);
  Scene scene;
  const Patch patch = point_world::random_patch(random);
  for (int i = 0; i < 3; ++i) {
    scene.add({0.001 * i, 0.0}, patch, Eigen::Vector3d::Zero(), random);
  }
  scene.features.resize(1);
  scene.match(kRecent);
  int matched = 0;
  for (const Candidate& c : scene.candidates) matched += c.corner == 0 ? 1 : 0;
  EXPECT_EQ(matched, 1);
}

TEST(Association, BetweenEqualLooksTheNearerWins) {
  Random random(1);
  Scene scene;
  const Patch patch = point_world::random_patch(random);
  scene.add({0.0, 0.0}, patch, Eigen::Vector3d::Zero(), random);
  Feature far = scene.features[0];
  far.zx += 0.02F;
  scene.features.insert(scene.features.begin(), far);
  scene.match(kRecent);
  EXPECT_EQ(scene.candidates[0].corner, 1);
}

TEST(Association, RefusesOtherLooksOtherDirectionsAndFarCorners) {
  Random random(5);
  const Patch patch = point_world::random_patch(random);
  const auto corner_of = [&](auto&& change) {
    auto scene = std::make_unique<Scene>();
    scene->add({0.1, 0.1}, patch, Eigen::Vector3d::Zero(), random);
    change(*scene);
    scene->match(kRecent);
    return scene->candidates[0].corner;
  };
  EXPECT_EQ(corner_of([](Scene&) {}), 0);
  EXPECT_EQ(corner_of([](Scene& s) { s.features[0].orientation_rad = 1.0F; }), -1);
  EXPECT_EQ(corner_of([](Scene& s) { s.features[0].zx += 0.2F; }), -1);
  EXPECT_EQ(corner_of([](Scene& s) { s.features[0].described = false; }), -1);
  EXPECT_EQ(corner_of([](Scene& s) { s.used[0] = true; }), -1);
  EXPECT_EQ(corner_of([](Scene& s) { s.candidates[0].promoted = false; }), -1);
  EXPECT_EQ(corner_of([](Scene& s) { s.candidates[0].old = true; }), -1);
  EXPECT_EQ(corner_of([&](Scene& s) { s.features[0].patch = point_world::random_patch(random); }),
            -1);
}

// 60 matches, of which a quarter show another place within the gate: the pose is found to three of
// its sigmas and the wrong ones are no inliers. 100 frames.
TEST(Association, MatchesAgreeOnThePose) {
  const TestSeed seed;
  Random random(seed.value());
  const Eigen::Matrix3d prior = Eigen::Vector3d(4e-4, 1e-4, 1e-3).asDiagonal();
  double chi2 = 0.0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d xi(0.02 * random.normal(), 0.01 * random.normal(),
                             0.03 * random.normal());
    const auto scene = spread_scene(random, 60, xi);
    for (std::size_t i = 0; i < 60; ++i) {
      scene->candidates[i].corner = static_cast<int>(i);
      if (i % 4 != 0) continue;
      scene->features[i].zx += static_cast<float>(random.uniform(0.05, 0.15));
      scene->features[i].zy -=
          static_cast<float>(random.uniform(0.05, 0.15) * (random.uniform() < 0.5 ? 1.0 : -1.0));
    }
    const PoseCorrection found = agree_on_pose(scene->candidates, kRecent, scene->features, prior,
                                               Eigen::Vector3d::Zero(), 3.5);
    EXPECT_GE(found.inliers, 42);
    EXPECT_LE(found.inliers, 46);
    for (std::size_t i = 0; i < 60; i += 4) EXPECT_FALSE(scene->candidates[i].inlier);
    const Eigen::Vector3d e = found.xi - xi;
    EXPECT_LT(e.norm(), 0.02);
    chi2 += e.dot(found.covariance.inverse() * e) / kTrials;
  }
  // Cauchy's weights cost some efficiency, and outliers pull a little: between 2 and 8, not 3.
  EXPECT_GT(chi2, 2.0);
  EXPECT_LT(chi2, 8.0);
}

TEST(Association, WithoutMatchesThePriorStays) {
  const Eigen::Matrix3d prior = Eigen::Vector3d(0.01, 0.02, 0.03).asDiagonal();
  std::vector<Candidate> none;
  const PoseCorrection found =
      agree_on_pose(none, kRecent, {}, prior, Eigen::Vector3d::Ones(), 3.5);
  EXPECT_EQ(found.inliers, 0);
  EXPECT_LT(found.xi.norm(), 1e-12);
  EXPECT_LT((found.covariance - prior).norm(), 1e-6);
}

}  // namespace
}  // namespace zenith
