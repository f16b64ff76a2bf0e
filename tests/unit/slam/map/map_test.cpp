// The map's store: what happens when it is full, and that it recovers.

#include "slam/map/map.h"

#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "slam/filter/particles.h"
#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"

namespace zenith {
namespace {

constexpr int kParticles = 4;

struct Rig {
  Map map;
  Particles particles;
  ArenaBlock block{[this](Arena& arena) {
    map.layout(arena, kParticles);
    particles.layout(arena, kParticles);
  }};

  Rig() {
    map.reset();
    place(0.0);
  }
  void place(double x_m) {
    for (int i = 0; i < kParticles; ++i) particles.set_pose(i, {x_m + i, 0.5 * i, 0.1 * i});
    place_cameras(particles, Eigen::Vector2d::Zero());
  }
  int anchor() { return map.create_anchor(particles.camera, PoseSensitivity::Zero()); }
};

std::unique_ptr<Rig> make_rig() {
  return std::make_unique<Rig>();
}

TEST(Map, GivesLandmarksUntilItIsFullAndAgainAfterwards) {
  const auto rig = make_rig();
  const int anchor = rig->anchor();
  std::set<std::uint32_t> ids;
  std::set<int> slots;
  for (int i = 0; i < kMaxLandmarks; ++i) {
    const int slot = rig->map.create(anchor);
    ASSERT_GE(slot, 0);
    EXPECT_TRUE(slots.insert(slot).second);
    EXPECT_TRUE(ids.insert(rig->map.info(slot).id).second);
    EXPECT_EQ(rig->map.info(slot).state, LandmarkState::kTentative);
  }
  EXPECT_EQ(rig->map.size(), kMaxLandmarks);
  EXPECT_EQ(rig->map.create(anchor), -1);
  EXPECT_EQ(rig->map.create(anchor), -1);
  for (const int slot : {0, 77, kMaxLandmarks - 1}) {
    rig->map.remove(slot);
    EXPECT_EQ(rig->map.info(slot).state, LandmarkState::kFree);
  }
  EXPECT_EQ(rig->map.size(), kMaxLandmarks - 3);
  for (int i = 0; i < 3; ++i) {
    const int slot = rig->map.create(anchor);
    ASSERT_GE(slot, 0);
    // A slot comes back, an id never.
    EXPECT_TRUE(ids.insert(rig->map.info(slot).id).second);
  }
  EXPECT_EQ(rig->map.create(anchor), -1);
}

TEST(Map, GivesAnchorsUntilItIsFullAndAgainAfterwards) {
  const auto rig = make_rig();
  std::vector<int> held;
  for (int i = 0; i < kMaxAnchors; ++i) {
    const int anchor = rig->anchor();
    ASSERT_GE(anchor, 0);
    held.push_back(rig->map.create(anchor));
  }
  EXPECT_EQ(rig->anchor(), -1);
  EXPECT_EQ(rig->map.anchors_used(), kMaxAnchors);
  rig->map.remove(held[500]);  // the only one at its anchor
  EXPECT_EQ(rig->map.anchors_used(), kMaxAnchors - 1);
  const int again = rig->anchor();
  EXPECT_GE(again, 0);
  EXPECT_EQ(rig->anchor(), -1);
  rig->map.release_if_unused(again);  // nobody came
  EXPECT_EQ(rig->map.anchors_used(), kMaxAnchors - 1);
}

TEST(Map, AnchorStaysWhileOneLandmarkHoldsIt) {
  const auto rig = make_rig();
  const int anchor = rig->anchor();
  const int a = rig->map.create(anchor);
  const int b = rig->map.create(anchor);
  rig->map.release_if_unused(anchor);
  EXPECT_EQ(rig->map.anchors_used(), 1);
  rig->map.remove(a);
  EXPECT_EQ(rig->map.anchors_used(), 1);
  rig->map.remove(b);
  EXPECT_EQ(rig->map.anchors_used(), 0);
}

TEST(Map, LandmarkHasAtMostTwentyLooks) {
  const auto rig = make_rig();
  Random random(1);
  const int slot = rig->map.create(rig->anchor());
  const Patch patch = point_world::random_patch(random);
  for (int i = 0; i < kMaxAppearances; ++i) {
    EXPECT_TRUE(rig->map.add_appearance(slot, patch, compact(patch), 0.0F));
  }
  EXPECT_FALSE(rig->map.add_appearance(slot, patch, compact(patch), 0.0F));
  EXPECT_EQ(rig->map.info(slot).appearance_count, kMaxAppearances);
}

// Adds looks as long as there is room; how many.
int add_looks(Map& map, int slot) {
  int count = 0;
  while (map.add_appearance(slot, {}, {}, 0.0F)) ++count;
  return count;
}

TEST(Map, LooksRunOutButForTheFirstOfEachLandmarkThatMayCome) {
  const auto rig = make_rig();
  const int anchor = rig->anchor();
  int taken = 0;
  int got = kMaxAppearances;
  int rich = -1;
  while (got == kMaxAppearances) {
    rich = rig->map.create(anchor);
    ASSERT_GE(rich, 0);
    taken += got = add_looks(rig->map, rich);
  }
  EXPECT_GE(taken, kAppearancePool - kMaxLandmarks) << "only first looks are left";
  while (rig->map.size() < kMaxLandmarks) {
    const int poor = rig->map.create(anchor);
    ASSERT_TRUE(rig->map.add_appearance(poor, {}, {}, 0.0F));
    if (rig->map.size() < kMaxLandmarks) {
      ASSERT_FALSE(rig->map.add_appearance(poor, {}, {}, 0.0F));
    }
  }
}

TEST(Map, LooksComeBackWithTheirLandmark) {
  const auto rig = make_rig();
  const int anchor = rig->anchor();
  const int first = rig->map.create(anchor);
  ASSERT_EQ(add_looks(rig->map, first), kMaxAppearances);
  int last = first;
  while (add_looks(rig->map, last = rig->map.create(anchor)) == kMaxAppearances) continue;
  EXPECT_EQ(add_looks(rig->map, last), 0);
  rig->map.remove(first);
  // All but the one that is kept for the removed landmark's successor.
  EXPECT_EQ(add_looks(rig->map, rig->map.create(anchor)), kMaxAppearances);
}

TEST(Map, BestNccHeedsTheDirection) {
  const auto rig = make_rig();
  Random random(3);
  const int slot = rig->map.create(rig->anchor());
  const Patch a = point_world::random_patch(random);
  const Patch b = point_world::random_patch(random);
  EXPECT_EQ(rig->map.best_ncc(slot, a, 0.0F, 0.6F), -1.0F);  // no look yet
  rig->map.add_appearance(slot, a, compact(a), 3.0F);
  rig->map.add_appearance(slot, b, compact(b), 0.0F);
  EXPECT_NEAR(rig->map.best_ncc(slot, a, -3.0F, 0.6F), 1.0F, 1e-5F);  // across pi: 0.28 apart
  EXPECT_NEAR(rig->map.best_ncc(slot, b, 0.5F, 0.6F), 1.0F, 1e-5F);
  EXPECT_LT(rig->map.best_ncc(slot, a, 0.0F, 0.6F), 0.9F);  // b alone is allowed
  EXPECT_EQ(rig->map.best_ncc(slot, a, 1.5F, 0.6F), -1.0F);
}

TEST(Map, PlaceFollowsTheRows) {
  const auto rig = make_rig();
  rig->place(2.0);
  const int slot = rig->map.create(rig->anchor());
  start_landmark(rig->map.rows(slot), kParticles, 0.0F, 0.0F, 1e-6F, 0.5F, 0.001F);
  const std::array<double, kParticles> weight = {0.0, 1.0, 0.0, 0.0};
  rig->map.refresh_place(slot, weight.data(), 0.3);
  const LandmarkInfo& l = rig->map.info(slot);
  EXPECT_NEAR(l.x_m, 3.0F, 1e-5F);  // over the second particle
  EXPECT_NEAR(l.y_m, 0.5F, 1e-5F);
  EXPECT_NEAR(l.z_m, 2.3F, 1e-5F);
  EXPECT_NEAR(l.rho, 0.5F, 1e-6F);
  EXPECT_NEAR(l.rho_sigma, 0.001F, 1e-5F);
  EXPECT_GT(l.covariance()(2, 2), 0.0);
  EXPECT_TRUE(l.covariance().isApprox(l.covariance().transpose()));
}

// What the calibration teaches moves rows when they are next touched, once: an estimate that is the
// truth and B beta comes to the truth when beta is known.
TEST(Map, RowsFollowTheCalibration) {
  const auto rig = make_rig();
  PoseSensitivity A = PoseSensitivity::Zero();
  A(0, 0) = 2.0;
  A(2, 1) = 1.0;
  const int slot = rig->map.create(rig->map.create_anchor(rig->particles.camera, A));
  start_landmark(rig->map.rows(slot), kParticles, 0.5F, 0.25F, 1e-4F, 0.4F, 0.1F);
  rig->map.by_calibration(slot)(0, 0) = 3.0;
  rig->map.by_calibration(slot)(2, 1) = -1.0;
  const LandmarkRows before = rig->map.rows(slot);
  const float anchor_x = before.anchor_x[1];
  const float heading = std::atan2(before.anchor_sin[1], before.anchor_cos[1]);
  CalibrationVector beta;
  beta << 0.01, 0.02, 0.0, 0.0, 0.0;
  rig->map.set_calibration(beta);
  for (int touch = 0; touch < 3; ++touch) {
    const LandmarkRows rows = rig->map.rows(slot);
    EXPECT_NEAR(rows.ax[1], 0.47F, 1e-6F);
    EXPECT_NEAR(rows.ay[1], 0.25F, 1e-6F);
    EXPECT_NEAR(rows.rho[1], 0.42F, 1e-6F);
    EXPECT_NEAR(rows.anchor_x[1], anchor_x - 0.02F, 1e-6F);
    EXPECT_NEAR(std::atan2(rows.anchor_sin[1], rows.anchor_cos[1]), heading - 0.02F, 1e-6F);
  }
  // A landmark made today is already right for today's calibration.
  const int late = rig->map.create(rig->anchor());
  start_landmark(rig->map.rows(late), kParticles, 0.5F, 0.25F, 1e-4F, 0.4F, 0.1F);
  rig->map.by_calibration(late)(0, 0) = 3.0;
  EXPECT_EQ(rig->map.rows(late).ax[1], 0.5F);
}

// Two parts of a map that a closing has tied go on as one rigid body, whatever the calibration
// turns out to be; what was learned before the closing moved each part in its own way.
TEST(Map, ATiedPieceGoesWithTheOtherPart) {
  const auto rig = make_rig();
  const auto landmark_at = [&](double x_m, const PoseSensitivity& A, double drift_m) {
    rig->place(x_m);
    const int slot = rig->map.create(rig->map.create_anchor(rig->particles.camera, A, drift_m));
    start_landmark(rig->map.rows(slot), kParticles, 0.0F, 0.0F, 1e-4F, 0.4F, 0.1F);
    return slot;
  };
  const auto place = [&](int slot) {
    rig->map.rows(slot);
    return rig->map.anchor_m(slot);
  };
  // Of the tilt forward: the old part goes straight, the recent one turns about a place far away.
  PoseSensitivity of_old = PoseSensitivity::Zero();
  of_old(0, 0) = 2.0;
  PoseSensitivity of_recent = PoseSensitivity::Zero();
  of_recent(1, 0) = 300.0;
  of_recent(2, 0) = 5.0;
  PoseSensitivity of_later = of_recent;
  of_later(1, 0) += 5.0 * 5.0;
  const int old = landmark_at(0.0, of_old, 0.0);
  const int recent = landmark_at(4.0, of_recent, 80.0);
  const int later = landmark_at(9.0, of_later, 85.0);
  CalibrationVector beta = CalibrationVector::Zero();
  beta[0] = 1e-3;
  rig->map.set_calibration(beta);
  rig->map.tie_piece({0.0, 10.0, 40.0, 1e9}, of_old - of_recent, {4.0, -0.3});
  EXPECT_LT((place(old) - Eigen::Vector2d(-0.002, 0.0)).norm(), 1e-5);
  EXPECT_LT((place(recent) - Eigen::Vector2d(4.0, -0.3)).norm(), 1e-5);
  EXPECT_LT((place(later) - Eigen::Vector2d(9.0, -0.325)).norm(), 1e-5);
  beta[0] = 5e-3;
  rig->map.set_calibration(beta);
  EXPECT_LT((place(old) - Eigen::Vector2d(-0.010, 0.0)).norm(), 1e-5);
  EXPECT_LT((place(recent) - Eigen::Vector2d(3.992, -0.3)).norm(), 1e-5);
  EXPECT_LT((place(later) - Eigen::Vector2d(8.992, -0.325)).norm(), 1e-3);
}

}  // namespace
}  // namespace zenith
