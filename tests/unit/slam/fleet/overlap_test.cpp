#include "slam/fleet/overlap.h"

#include <gtest/gtest.h>

#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith {
namespace {

using point_world::PeerRig;
using point_world::PointWorld;

TEST(Overlap, FindsTheSameLandmarksAndTheHeading) {
  const TestSeed seed;
  Random random(seed.value());
  const PointWorld world = PointWorld::scatter(random, 200, -8.0, 8.0, -8.0, 8.0);
  const Pose2 T_peer_world = {4.0, 5.0, 1.3};
  const Pose2 T_world_robot = {1.0, -2.0, -0.6};
  const PeerRig peer(world, T_peer_world);
  ObservedFrame frame;
  observe_near(world, T_world_robot, 3.0, 0.0, random, frame);
  OverlapMatches matches;
  find_overlap(frame, peer.map, {}, matches);
  int right = 0;
  for (const OverlapMatch& m : matches) {
    EXPECT_GE(m.ncc, 0.75F);
    EXPECT_GT(m.weight, 0.0F);
    EXPECT_LE(m.weight, 1.0F);
    if (m.peer_slot != frame[static_cast<std::size_t>(m.observed)].slot) continue;
    ++right;
    EXPECT_NEAR(m.ncc, 1.0F, 1e-3F);
    EXPECT_NEAR(m.heading_rad, 0.7F, 1e-5F);  // the robot's in the peer's frame: 1.3 - 0.6
  }
  EXPECT_EQ(right, static_cast<int>(frame.size()));
}

TEST(Overlap, HeightsNarrowTheSearch) {
  Observed own;
  own.z_m = 2.5;
  own.z_sigma_m = 0.03;
  PeerLandmark peer;
  peer.covariance_m2[5] = 0.04F * 0.04F;
  // 0.15 m and three sigmas of both: 0.05 m.
  peer.z_m = 2.79F;
  EXPECT_TRUE(heights_agree(own, peer, 0.15));
  peer.z_m = 2.81F;
  EXPECT_FALSE(heights_agree(own, peer, 0.15));
  peer.z_m = 2.19F;
  EXPECT_FALSE(heights_agree(own, peer, 0.15));
}

TEST(Overlap, ALookThatFitsManySaysLittle) {
  Random random(2);
  PointWorld world = PointWorld::scatter(random, 30, -3.0, 3.0, -3.0, 3.0, 2.5, 2.5);
  for (auto& l : world.landmarks) {
    l.patch = world.landmarks[0].patch;
    l.compact = world.landmarks[0].compact;
  }
  const PeerRig peer(world, {});
  ObservedFrame frame;
  frame.push_back(observed_of(world.landmarks[0], 0, {}, 0.0, random));
  OverlapMatches matches;
  find_overlap(frame, peer.map, {}, matches);
  EXPECT_EQ(matches.size(), static_cast<std::size_t>(kMatchesPerObserved));
  for (const OverlapMatch& m : matches) EXPECT_NEAR(m.weight, 1.0 / std::sqrt(30.0), 1e-6);
}

TEST(Overlap, TheBestLookCounts) {
  Random random(4);
  const PointWorld world = PointWorld::scatter(random, 1, -1.0, 1.0, -1.0, 1.0);
  PeerRig peer(world, {});
  LandmarkRecord more = record_of(world.landmarks[0], 1, 2, {});
  more.appearance_count = 2;
  more.appearances[0] = {compact(point_world::random_patch(random)).values, 0.1F};
  more.appearances[1] = {world.landmarks[0].compact.values, 0.2F};
  ASSERT_TRUE(peer.map.apply(more));
  ObservedFrame frame;
  frame.push_back(observed_of(world.landmarks[0], 0, {}, 0.0, random));
  OverlapMatches matches;
  find_overlap(frame, peer.map, {}, matches);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_NEAR(matches[0].ncc, 1.0F, 1e-4F);
  EXPECT_FLOAT_EQ(matches[0].heading_rad, 0.2F - frame[0].orientation_rad);
}

TEST(Overlap, RemovedLandmarksAreNotFound) {
  Random random(6);
  const PointWorld world = PointWorld::scatter(random, 1, -1.0, 1.0, -1.0, 1.0);
  PeerRig peer(world, {});
  LandmarkRecord removal = record_of(world.landmarks[0], 1, 2, {});
  removal.removed = true;
  peer.map.apply(removal);
  ObservedFrame frame;
  frame.push_back(observed_of(world.landmarks[0], 0, {}, 0.0, random));
  OverlapMatches matches;
  find_overlap(frame, peer.map, {}, matches);
  EXPECT_TRUE(matches.empty());
}

}  // namespace
}  // namespace zenith
