#include "slam/fleet/hypothesis.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "slam/fleet/peer.h"
#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/own_map.h"

namespace zenith {
namespace {

using point_world::OwnMapRig;
using point_world::PeerRig;
using point_world::PointWorld;

TEST(Hypothesis, ScoreIsTheLogOddsOfItsWindow) {
  Hypothesis h;
  EXPECT_EQ(h.score(), 0.0);
  h.evidence.add({20, 20});
  h.evidence.add({10, 15});
  EXPECT_EQ(h.hits(), 30);
  EXPECT_EQ(h.expected(), 35);
  EXPECT_NEAR(h.score(), 30.0 * std::log(0.9 / 0.6) + 5.0 * std::log(0.1 / 0.4), 1e-12);
  // A miss outweighs three hits: a wrong alignment that finds 60 % loses.
  Hypothesis wrong;
  for (int i = 0; i < Evidence::kWindow; ++i) wrong.evidence.add({12, 20});
  EXPECT_LT(wrong.score(), 0.0);
  Hypothesis right;
  for (int i = 0; i < Evidence::kWindow; ++i) right.evidence.add({18, 20});
  EXPECT_GT(right.score(), 0.0);
}

TEST(Hypothesis, PairsAreConfirmedAndContested) {
  auto h = std::make_unique<Hypothesis>();
  EXPECT_TRUE(confirm_pair(*h, {3, 30, 7, 70, 1}));
  EXPECT_TRUE(confirm_pair(*h, {3, 30, 7, 70, 1}));
  ASSERT_EQ(h->pairs.size(), 1U);
  EXPECT_EQ(h->pairs[0].seen, 2);
  EXPECT_FALSE(confirm_pair(*h, {4, 40, 7, 70, 1}));  // the peer's landmark has a partner
  EXPECT_EQ(h->pairs[0].own_slot, 3);
  EXPECT_TRUE(confirm_pair(*h, {4, 40, 7, 70, 1}));  // once more, and the partner gives way
  ASSERT_EQ(h->pairs.size(), 1U);
  EXPECT_EQ(h->pairs[0].own_slot, 4);
}

struct PooledHypotheses {
  HypothesisPool pool;
  ArenaBlock block{[this](Arena& arena) { pool.layout(arena); }};
};

TEST(Hypothesis, WithoutAPoolItKeepsOneBlockOfPairs) {
  auto h = std::make_unique<Hypothesis>();
  for (int i = 0; i < kPairBlock; ++i) {
    ASSERT_TRUE(confirm_pair(*h, {i, 1, i, static_cast<std::uint32_t>(i), 1}));
  }
  EXPECT_FALSE(confirm_pair(*h, {kPairBlock, 1, kPairBlock, 999, 1}));
}

TEST(Hypothesis, PairsOfADroppedOneAreFreeForOthers) {
  PooledHypotheses rig;
  const auto fill = [](Hypothesis& h) {
    int pairs = 0;
    while (pairs <= kMaxCorrespondences &&
           confirm_pair(h, {pairs, 7, pairs, static_cast<std::uint32_t>(pairs), 1})) {
      ++pairs;
    }
    return pairs;
  };
  std::vector<Hypothesis*> whole;
  int got = kMaxCorrespondences;
  while (got == kMaxCorrespondences) {
    whole.push_back(rig.pool.take());
    got = fill(*whole.back());
  }
  // 48 have all of theirs in kPairBlocks; the next one gets what is left.
  constexpr int kFurther = kMaxCorrespondences / kPairBlock - 1;
  EXPECT_EQ(whole.size(), static_cast<std::size_t>(kPairBlocks / kFurther) + 1);
  EXPECT_EQ(got, kPairBlock * (1 + kPairBlocks % kFurther));
  for (int i = 0; i < got; ++i) {
    ASSERT_EQ(whole.back()->pairs[static_cast<std::size_t>(i)].own_slot, i);
  }
  rig.pool.give_back(whole.front());
  Hypothesis& next = *rig.pool.take();
  EXPECT_EQ(next.pairs.size(), 0U);
  EXPECT_EQ(fill(next), kMaxCorrespondences);
  EXPECT_EQ(whole[1]->pairs[kMaxCorrespondences - 1].own_slot, kMaxCorrespondences - 1)
      << "others keep theirs";
}

TEST(Hypothesis, FullOfPairsRejects) {
  PooledHypotheses rig;
  Hypothesis* h = rig.pool.take();
  for (int i = 0; i < kMaxCorrespondences; ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    ASSERT_TRUE(confirm_pair(*h, {i, id, i, id, 1}));
  }
  EXPECT_FALSE(confirm_pair(*h, {9999, 9999, 9999, 9999, 1}));
  EXPECT_TRUE(confirm_pair(*h, {5, 5, 5, 5, 1}));
}

TEST(Hypothesis, SameAlignmentIsJudgedWhereTheRobotIs) {
  const Pose2 a = {1.0, 2.0, 0.5};
  EXPECT_TRUE(same_alignment(a, a, {0.0, 0.0}));
  EXPECT_TRUE(same_alignment(a, {1.2, 2.1, 0.5}, {0.0, 0.0}));
  EXPECT_FALSE(same_alignment(a, {1.5, 2.0, 0.5}, {0.0, 0.0}));
  EXPECT_FALSE(same_alignment(a, {1.0, 2.0, 0.7}, {1.0, 2.0}));
  // Three degrees apart: the same near the pivot, another one 20 m from it.
  const Pose2 b = {1.0, 2.0, 0.55};
  EXPECT_TRUE(same_alignment(a, b, {1.0, 2.0}));
  EXPECT_FALSE(same_alignment(a, b, {21.0, 2.0}));
}

// The robot's start frame is the world; the peer's is elsewhere.
struct Scene {
  Random random;
  PointWorld world;
  OwnMapRig own;
  Pose2 T_peer_world = {3.0, -2.0, 1.1};
  PeerRig peer;
  ObservedFrame frame;
  Pose2 T_own_robot = {0.5, 0.3, -0.4};
  Hypothesis h;

  explicit Scene(std::uint64_t seed)
      : random(seed),
        world(PointWorld::scatter(random, 120, -6.0, 6.0, -6.0, 6.0)),
        peer(world, T_peer_world) {
    for (const auto& l : world.landmarks) own.add(l);
    observe_near(world, T_own_robot, 3.0, 0.01, random, frame);
    h.covariance = Eigen::Vector3d(0.0025, 0.0025, 0.0004).asDiagonal();
    h.T_own_peer = T_peer_world.inverse();
  }
};

TEST(Hypothesis, TheRightOneFindsWhatItExpects) {
  const TestSeed seed;
  const auto s = std::make_unique<Scene>(seed.value());
  const FrameTest test = test_hypothesis(s->h, s->frame, s->peer.map, s->T_own_robot, {});
  EXPECT_EQ(test.support.expected, static_cast<int>(s->frame.size()));
  EXPECT_GE(test.support.hits, test.support.expected - 1);
  ASSERT_TRUE(test.found);
  const Pose2 truth = s->T_peer_world * s->T_own_robot;
  EXPECT_LT((test.T_peer_robot.position() - truth.position()).norm(), 0.02);
  EXPECT_NEAR(wrap_angle(test.T_peer_robot.theta_rad - truth.theta_rad), 0.0, 0.01);
  EXPECT_EQ(s->h.pairs.size(), static_cast<std::size_t>(test.support.hits));
  for (const LandmarkPair& p : s->h.pairs) EXPECT_EQ(p.own_slot, p.peer_slot);
}

TEST(Hypothesis, AWrongOneFindsLittle) {
  const TestSeed seed;
  const auto s = std::make_unique<Scene>(seed.value());
  s->h.T_own_peer = Pose2{1.0, 0.7, 0.0} * s->T_peer_world.inverse();
  const FrameTest test = test_hypothesis(s->h, s->frame, s->peer.map, s->T_own_robot, {});
  EXPECT_GE(test.support.expected, 5);
  EXPECT_LT(test.support.hits, test.support.expected / 3);
  EXPECT_LT(s->h.score(), 0.0);
}

TEST(Hypothesis, WhereThePeerHasNothingNothingIsExpected) {
  const TestSeed seed;
  const auto s = std::make_unique<Scene>(seed.value());
  s->h.T_own_peer = Pose2{100.0, 0.0, 0.0} * s->T_peer_world.inverse();
  const FrameTest test = test_hypothesis(s->h, s->frame, s->peer.map, s->T_own_robot, {});
  EXPECT_EQ(test.support.expected, 0);
  EXPECT_FALSE(test.found);
  EXPECT_EQ(s->h.score(), 0.0);
}

TEST(Hypothesis, RefitFollowsThePairsAndForgetsTheDead) {
  const TestSeed seed;
  const auto s = std::make_unique<Scene>(seed.value());
  for (int i = 0; i < 40; ++i) {
    confirm_pair(s->h, {i, s->own.map.info(i).id, i, s->peer.map[i].id, 1});
  }
  s->h.T_own_peer = Pose2{0.05, -0.05, 0.02} * s->T_peer_world.inverse();
  s->own.map.remove(3);
  LandmarkRecord removal = record_of(s->world.landmarks[5], 6, 2, s->T_peer_world);
  removal.removed = true;
  s->peer.map.apply(removal);
  s->own.move(8, s->world.landmarks[8].p_m + Eigen::Vector3d(1.0, 0.0, 0.0));
  refit(s->h, s->own.map, s->peer.map);
  EXPECT_EQ(s->h.pairs.size(), 37U);
  const Pose2 truth = s->T_peer_world.inverse();
  EXPECT_LT((s->h.T_own_peer.position() - truth.position()).norm(), 1e-4);
  EXPECT_NEAR(wrap_angle(s->h.T_own_peer.theta_rad - truth.theta_rad), 0.0, 1e-4);
  EXPECT_LT(s->h.covariance.trace(), 0.001);
}

}  // namespace
}  // namespace zenith
