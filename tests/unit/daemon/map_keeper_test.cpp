// When the map is written, and what: with nothing stored, before and after the robot found itself.

#include "platform/daemon/map_keeper.h"

#include <gtest/gtest.h>

#include "tests/support/faulty_folder.h"
#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"

namespace zenith {
namespace {

constexpr Duration kInterval = {5'000'000'000};

Time at(double seconds) {
  return Time{} + Duration::from_seconds(1000.0 + seconds);
}

class MapKeeperTest : public testing::Test {
 protected:
  MapStatus status(const MapKeeper& keeper) const {
    MapStatus status;
    EXPECT_TRUE(keeper.read(status));
    return status;
  }
  storage::StoredMap stored() {
    storage::MapStore store(folder_);
    auto loaded = store.load();
    EXPECT_TRUE(loaded.map.has_value());
    return loaded.map ? std::move(*loaded.map) : storage::StoredMap{};
  }
  void store_a_map(std::size_t count) {
    storage::MapStore store(folder_);
    past_ = storage::random_map(count, random_);
    ASSERT_TRUE(store.save(past_).ok());
  }

  const TestSeed seed_;
  Random random_{seed_.value(), 1};
  storage::FaultyFolder folder_{seed_.value()};
  storage::StoredMap past_;
  storage::StoredMap own_ = storage::random_map(40, random_);
};

TEST_F(MapKeeperTest, NewLandmarksAreWrittenSoonBetterKnownOnesLater) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  EXPECT_TRUE(keeper.load().empty());
  keeper.turn_once(at(0), nullptr);
  EXPECT_EQ(status(keeper).written, 0u) << "nothing to write";
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(1), nullptr);
  EXPECT_EQ(status(keeper).written, 1u);
  keeper.note(own_.landmarks[1]);
  keeper.turn_once(at(5.9), nullptr);
  EXPECT_EQ(status(keeper).written, 1u) << "not before its interval is over";
  keeper.turn_once(at(6.1), nullptr);
  EXPECT_EQ(status(keeper).written, 2u);
  keeper.note(own_.landmarks[1]);
  keeper.turn_once(at(60), nullptr);
  EXPECT_EQ(status(keeper).written, 2u);
  keeper.turn_once(at(67), nullptr);
  EXPECT_EQ(status(keeper).written, 3u);
  keeper.turn_once(at(200), nullptr);
  EXPECT_EQ(status(keeper).written, 3u) << "nothing changed";
  EXPECT_EQ(stored().landmarks.size(), 2u);
}

TEST_F(MapKeeperTest, TheEndWritesWhatIsNotWritten) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), nullptr);
  keeper.note(own_.landmarks[1]);
  keeper.finish(at(0.1), nullptr);
  EXPECT_EQ(stored().landmarks.size(), 2u);
}

TEST_F(MapKeeperTest, TheStoredMapStaysUntilTheRobotFoundItselfAndThenGoesOn) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  ASSERT_EQ(keeper.load().size(), 30u);
  for (const LandmarkRecord& r : own_.landmarks) keeper.note(r);
  keeper.turn_once(at(0), nullptr);
  EXPECT_EQ(status(keeper).written, 0u);
  EXPECT_FALSE(status(keeper).found);

  // The present start lies 100 m away and turned: no landmark of both is the same.
  PeerReport past;
  past.peer = kPastSlot;
  past.state = AlignmentState::kMerged;
  past.T_own_peer = Pose2{100.0, -20.0, 0.7};
  past.variance = {1e-4, 1e-4, 1e-6};
  keeper.turn_once(at(10), &past);
  EXPECT_TRUE(status(keeper).found);
  const storage::StoredMap map = stored();
  EXPECT_EQ(map.head.checkpoint, 2u);
  EXPECT_EQ(map.head.map, past_.head.map) << "it is the same map that goes on";
  ASSERT_EQ(map.landmarks.size(), 70u);
  const Eigen::Vector2d moved =
      past.T_own_peer.inverse() * Eigen::Vector2d(own_.landmarks[0].x_m, own_.landmarks[0].y_m);
  EXPECT_NEAR(map.landmarks[0].x_m, moved.x(), 0.002);
  EXPECT_NEAR(map.landmarks[0].y_m, moved.y(), 0.002);
}

TEST_F(MapKeeperTest, AnotherPlaceBeginsAnewAndLeavesTheStoredMap) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  const auto many = storage::random_map(MapKeeper::kNewMap, random_);
  for (const LandmarkRecord& r : many.landmarks) keeper.note(r);
  keeper.turn_once(at(0), nullptr);
  EXPECT_TRUE(folder_.exists("map-0.zenmap.left"));
  EXPECT_EQ(stored().landmarks.size(), MapKeeper::kNewMap);
  EXPECT_NE(stored().head.map, past_.head.map);
}

TEST_F(MapKeeperTest, AFullDiskIsToldOfUntilItIsNot) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  folder_.set_full(true);
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), nullptr);
  EXPECT_TRUE(status(keeper).failing);
  EXPECT_NE(status(keeper).error.view().find("ENOSPC"), std::string_view::npos);
  folder_.set_full(false);
  keeper.turn_once(at(6), nullptr);
  EXPECT_FALSE(status(keeper).failing);
  EXPECT_EQ(status(keeper).written, 1u);
  EXPECT_EQ(status(keeper).failed, 1u);
}

}  // namespace
}  // namespace zenith
