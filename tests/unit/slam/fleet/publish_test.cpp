#include "slam/fleet/publish.h"

#include <algorithm>
#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/slam/fleet/own_map.h"

namespace zenith {
namespace {

using point_world::OwnMapRig;
using point_world::PointWorld;

struct Rig {
  Random random{1};
  PointWorld world = PointWorld::scatter(random, 10, -3.0, 3.0, -3.0, 3.0);
  OwnMapRig own;
  std::array<LandmarkRecord, 64> out = {};

  Rig() {
    for (const auto& l : world.landmarks) own.add(l);
  }
  std::size_t publish() { return publish_changes(own.map, out); }
};

TEST(Publish, TellsEachLandmarkOnce) {
  const auto rig = std::make_unique<Rig>();
  ASSERT_EQ(rig->publish(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const LandmarkRecord& r = rig->out[i];
    const LandmarkInfo& l = rig->own.map.info(static_cast<int>(i));
    EXPECT_EQ(r.id, l.id);
    EXPECT_EQ(r.revision, 1U);
    EXPECT_FALSE(r.removed);
    EXPECT_EQ(r.x_m, l.x_m);
    EXPECT_EQ(r.covariance_m2[5], l.covariance_m2[5]);
    EXPECT_EQ(r.observations, 10);
    ASSERT_EQ(r.appearance_count, 1);
    EXPECT_EQ(r.appearances[0].descriptor, rig->world.landmarks[i].compact.values);
  }
  EXPECT_EQ(rig->publish(), 0U);
}

TEST(Publish, TellsAgainWhatMovedOrBecameSharper) {
  const auto rig = std::make_unique<Rig>();
  rig->publish();
  Map& map = rig->own.map;
  rig->own.move(2, map.info(2).position_m() + Eigen::Vector3d(0.02, 0.0, 0.0));
  rig->own.move(3, map.info(3).position_m() + Eigen::Vector3d(0.002, 0.0, 0.0));  // too little
  for (float& c : map.info(4).covariance_m2) c *= 0.4F;
  map.info(4).changed = true;
  for (int i = 0; i < 2; ++i) map.add_appearance(5, {}, {}, 0.0F);
  map.info(5).changed = true;
  map.info(6).changed = true;  // seen again, nothing new
  ASSERT_EQ(rig->publish(), 3U);
  EXPECT_EQ(rig->out[0].id, map.info(2).id);
  EXPECT_EQ(rig->out[1].id, map.info(4).id);
  EXPECT_EQ(rig->out[2].id, map.info(5).id);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rig->out[i].revision, 2U);
  EXPECT_EQ(rig->publish(), 0U);
}

// Small steps add up: the comparison is with what was told, not with yesterday.
TEST(Publish, SmallStepsAddUp) {
  const auto rig = std::make_unique<Rig>();
  rig->publish();
  std::size_t told = 0;
  for (int i = 0; i < 10; ++i) {
    rig->own.move(0, rig->own.map.info(0).position_m() + Eigen::Vector3d(0.004, 0.0, 0.0));
    told += rig->publish();
  }
  EXPECT_EQ(told, 3U);
  EXPECT_EQ(rig->own.map.info(0).revision, 4U);
}

TEST(Publish, ContinuesWhereARoomWasTooSmall) {
  const auto rig = std::make_unique<Rig>();
  std::array<LandmarkRecord, 4> small = {};
  std::size_t told = 0;
  for (const std::size_t expected : {4U, 4U, 2U, 0U}) {
    const std::size_t n = publish_changes(rig->own.map, small);
    EXPECT_EQ(n, expected);
    told += n;
  }
  EXPECT_EQ(told, 10U);
}

TEST(Publish, TentativeLandmarksStayPrivate) {
  const auto rig = std::make_unique<Rig>();
  rig->own.map.info(1).state = LandmarkState::kTentative;
  EXPECT_EQ(rig->publish(), 9U);
}

TEST(Publish, TellsOfRemovedLandmarksThatPeersKnow) {
  const auto rig = std::make_unique<Rig>();
  const std::uint32_t unknown = rig->own.map.info(9).id;
  rig->own.map.remove(9);  // before anybody heard of it
  ASSERT_EQ(rig->publish(), 9U);
  const std::uint32_t known = rig->own.map.info(4).id;
  rig->own.map.remove(4);
  ASSERT_EQ(rig->publish(), 1U);
  EXPECT_TRUE(rig->out[0].removed);
  EXPECT_EQ(rig->out[0].id, known);
  EXPECT_NE(rig->out[0].id, unknown);
  EXPECT_EQ(rig->out[0].revision, 2U);
  EXPECT_EQ(rig->publish(), 0U);
}

TEST(Publish, AtMostEightLooksTheNewestFirst) {
  const auto rig = std::make_unique<Rig>();
  for (int i = 0; i < 12; ++i) {
    rig->own.map.add_appearance(0, {}, {}, 0.1F * static_cast<float>(i + 1));
  }
  rig->publish();
  ASSERT_EQ(rig->out[0].appearance_count, kPublishedAppearances);
  for (int i = 0; i < kPublishedAppearances; ++i) {
    EXPECT_FLOAT_EQ(rig->out[0].appearances[static_cast<std::size_t>(i)].direction_rad,
                    0.1F * static_cast<float>(12 - i));
  }
}

}  // namespace
}  // namespace zenith
