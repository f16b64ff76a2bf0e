// When the map is written, and what: with nothing stored, before and after the robot found itself.

#include "platform/daemon/map_keeper.h"

#include <gtest/gtest.h>

#include "platform/daemon/telemetry_lines.h"
#include "tests/support/faulty_folder.h"
#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

constexpr Duration kInterval = {5'000'000'000};

Time at(double seconds) {
  return Time{} + Duration::from_seconds(1000.0 + seconds);
}

class MapKeeperTest : public testing::Test {
 protected:
  MapKeeperTest() { own_.head.map = 99; }
  MapStatus status(const MapKeeper& keeper) const {
    MapStatus status;
    EXPECT_TRUE(keeper.read(status));
    return status;
  }
  storage::StoredMap stored(const char* name = storage::kMainMap) {
    storage::MapStore store(folder_, name);
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
  keeper.turn_once(at(0), {});
  EXPECT_EQ(status(keeper).written, 0u) << "nothing to write";
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(1), {});
  EXPECT_EQ(status(keeper).written, 1u);
  keeper.note(own_.landmarks[1]);
  keeper.turn_once(at(5.9), {});
  EXPECT_EQ(status(keeper).written, 1u) << "not before its interval is over";
  keeper.turn_once(at(6.1), {});
  EXPECT_EQ(status(keeper).written, 2u);
  keeper.note(own_.landmarks[1]);
  keeper.turn_once(at(60), {});
  EXPECT_EQ(status(keeper).written, 2u);
  keeper.turn_once(at(67), {});
  EXPECT_EQ(status(keeper).written, 3u);
  keeper.turn_once(at(200), {});
  EXPECT_EQ(status(keeper).written, 3u) << "nothing changed";
  EXPECT_EQ(stored().landmarks.size(), 2u);
}

TEST_F(MapKeeperTest, TheEndWritesWhatIsNotWritten) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), {});
  keeper.note(own_.landmarks[1]);
  keeper.finish(at(0.1), {});
  EXPECT_EQ(stored().landmarks.size(), 2u);
}

TEST_F(MapKeeperTest, UntilTheRobotFoundItselfItsSessionIsKeptBesideTheStoredMap) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  ASSERT_EQ(keeper.load().size(), 1u);
  for (const LandmarkRecord& r : own_.landmarks) keeper.note(r);
  keeper.turn_once(at(0), {});
  EXPECT_EQ(status(keeper).place.view(), "session-1");
  EXPECT_FALSE(status(keeper).found);
  EXPECT_EQ(stored().head.checkpoint, 1u) << "the stored one stays as it is";
  EXPECT_EQ(stored("session-1").landmarks.size(), 40u);

  // The present start lies 100 m away and turned: no landmark of both is the same.
  PeerReport past;
  past.peer = kPastSlot;
  past.state = AlignmentState::kMerged;
  past.T_own_peer = Pose2{100.0, -20.0, 0.7};
  past.variance = {1e-4, 1e-4, 1e-6};
  keeper.turn_once(at(10), {&past, 1});
  EXPECT_TRUE(status(keeper).found);
  EXPECT_FALSE(folder_.exists("session-1-0.zenmap")) << "it is in the stored map now";
  const storage::StoredMap map = stored();
  EXPECT_EQ(map.head.checkpoint, 2u);
  EXPECT_EQ(map.head.map, past_.head.map) << "it is the same map that goes on";
  ASSERT_EQ(map.landmarks.size(), 70u);
  const Eigen::Vector2d moved =
      past.T_own_peer.inverse() * Eigen::Vector2d(own_.landmarks[0].x_m, own_.landmarks[0].y_m);
  EXPECT_NEAR(map.landmarks[0].x_m, moved.x(), 0.002);
  EXPECT_NEAR(map.landmarks[0].y_m, moved.y(), 0.002);
}

TEST_F(MapKeeperTest, WhenItWasWrongTheStoredMapIsWrittenBackAsItWas) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  for (const LandmarkRecord& r : own_.landmarks) keeper.note(r);
  PeerReport past;
  past.peer = kPastSlot;
  past.state = AlignmentState::kMerged;
  past.T_own_peer = Pose2{100.0, -20.0, 0.7};
  keeper.turn_once(at(0), {&past, 1});
  EXPECT_EQ(stored().landmarks.size(), 70u);
  past.state = AlignmentState::kWithdrawn;
  keeper.turn_once(at(6), {&past, 1});
  EXPECT_EQ(stored().landmarks.size(), 30u);
  EXPECT_EQ(stored("session-1").landmarks.size(), 40u);
  past.state = AlignmentState::kMerged;
  keeper.turn_once(at(12), {&past, 1});
  EXPECT_EQ(stored().landmarks.size(), 70u);
  EXPECT_FALSE(folder_.exists("session-1-0.zenmap"));
}

TEST_F(MapKeeperTest, FoundInAnEarlierSessionAloneThatOneGoesOn) {
  store_a_map(30);
  storage::StoredMap earlier = storage::random_map(20, random_);
  earlier.head.map = 7;
  storage::MapStore session(folder_, "session-1");
  ASSERT_TRUE(session.save(earlier).ok());
  MapKeeper keeper(folder_, own_.head, kInterval);
  const auto past = keeper.load();
  ASSERT_EQ(past.size(), 2u);
  EXPECT_TRUE(past[0].whole);
  EXPECT_FALSE(past[1].whole) << "it asks for as much as a peer's map";
  EXPECT_EQ(status(keeper).sessions, 1u);
  for (const LandmarkRecord& r : own_.landmarks) keeper.note(r);
  keeper.turn_once(at(0), {});
  EXPECT_EQ(status(keeper).place.view(), "session-2");
  std::vector<PeerReport> found(1);
  found[0].peer = past[1].slot;
  found[0].state = AlignmentState::kMerged;
  found[0].T_own_peer = Pose2{100.0, -20.0, 0.7};
  keeper.turn_once(at(6), found);
  EXPECT_FALSE(status(keeper).found) << "not in the main map";
  EXPECT_EQ(stored("session-1").landmarks.size(), 60u);
  EXPECT_EQ(stored("session-1").head.map, 7u);
  EXPECT_FALSE(folder_.exists("session-2-0.zenmap"));
  // And then in the main map: all three are one.
  found.push_back(found[0]);
  found[1].peer = kPastSlot;
  found[1].T_own_peer = Pose2{-200.0, 0.0, -1.0};
  keeper.turn_once(at(12), found);
  EXPECT_EQ(stored().landmarks.size(), 90u);
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"map-0.zenmap", "map-1.zenmap"}));
}

TEST_F(MapKeeperTest, WithoutAMainMapTheLargestSessionStandsForIt) {
  storage::StoredMap earlier = storage::random_map(20, random_);
  storage::MapStore session(folder_, "session-3");
  ASSERT_TRUE(session.save(earlier).ok());
  MapKeeper keeper(folder_, own_.head, kInterval);
  ASSERT_EQ(keeper.load().size(), 1u);
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), {});
  EXPECT_EQ(status(keeper).place.view(), "session-1");
  PeerReport past;
  past.peer = kPastSlot;
  past.state = AlignmentState::kMerged;
  past.T_own_peer = Pose2{100.0, -20.0, 0.7};
  keeper.turn_once(at(6), {&past, 1});
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"map-0.zenmap"});
  EXPECT_EQ(stored().landmarks.size(), 21u);
}

TEST_F(MapKeeperTest, WithAllPlacesTakenTheSmallestSessionGivesWay) {
  store_a_map(30);
  for (std::size_t i = 0; i < storage::kSessionMaps.size(); ++i) {
    storage::StoredMap map = storage::random_map(i == 1 ? 5 : 20, random_);
    storage::MapStore session(folder_, storage::kSessionMaps[i]);
    ASSERT_TRUE(session.save(map).ok());
  }
  {
    MapKeeper keeper(folder_, own_.head, kInterval);
    EXPECT_EQ(keeper.load().size(), 4u);
  }
  EXPECT_EQ(stored("session-2").landmarks.size(), 5u) << "not before there is something better";
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  for (const LandmarkRecord& r : own_.landmarks) keeper.note(r);
  keeper.turn_once(at(0), {});
  EXPECT_EQ(stored("session-2").landmarks.size(), 40u);
}

TEST_F(MapKeeperTest, AnotherPlaceBeginsAnewAndLeavesTheStoredMap) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  const auto many = storage::random_map(MapKeeper::kNewMap, random_);
  for (const LandmarkRecord& r : many.landmarks) keeper.note(r);
  keeper.turn_once(at(0), {});
  EXPECT_TRUE(folder_.exists("map-0.zenmap.left"));
  EXPECT_TRUE(status(keeper).left);
  EXPECT_TRUE(keeper.left_main());
  EXPECT_EQ(stored().landmarks.size(), MapKeeper::kNewMap);
  EXPECT_NE(stored().head.map, past_.head.map);
}

// Perception finds the robot in the old map at the very moment at which that is abandoned: nothing
// is told of it, and the new map does not begin in the old one's frame.
TEST_F(MapKeeperTest, NothingIsToldInTheFrameOfAnAbandonedMap) {
  store_a_map(30);
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  const auto many = storage::random_map(MapKeeper::kNewMap, random_);
  for (const LandmarkRecord& r : many.landmarks) keeper.note(r);
  folder_.set_full(true);  // the new map is not on the disk yet
  keeper.turn_once(at(0), {});
  ASSERT_TRUE(status(keeper).left) << "said all the same";
  PerceptionReport report;
  report.peers.push_back({});
  PeerReport past;
  past.peer = kPastSlot;
  past.state = AlignmentState::kMerged;
  past.T_own_peer = Pose2{100.0, -20.0, 0.7};
  report.peers.push_back(past);
  ASSERT_NE(past_self(report), nullptr);
  keep_what_counts(report, status(keeper));
  EXPECT_EQ(past_self(report), nullptr);
  EXPECT_EQ(report.peers.size(), 1);
  JsonLine pose;
  write_pose(pose, report);
  EXPECT_EQ(std::string(pose.finish()).find("map_pose"), std::string::npos);
  folder_.set_full(false);
  keeper.turn_once(at(6), report.peers.span());
  EXPECT_FALSE(status(keeper).found);
  EXPECT_EQ(stored().landmarks.size(), MapKeeper::kNewMap);
}

// Another program has the folder: nothing of it is read or written, and that is told. Once it is
// free this run's map goes beside what lies there, which the robot did not look for.
TEST_F(MapKeeperTest, AFolderOfAnotherProgramIsLeftAloneUntilItIsFree) {
  store_a_map(30);
  folder_.set_user(storage::FolderUser{812, "zenithd", "bert"});
  const int changes = folder_.changes();
  MapKeeper keeper(folder_, own_.head, kInterval);
  EXPECT_TRUE(keeper.load().empty());
  EXPECT_TRUE(status(keeper).failing) << "before there is anything to write";
  EXPECT_NE(status(keeper).error.view().find("zenithd (pid 812, robot bert)"),
            std::string_view::npos);
  const auto many = storage::random_map(MapKeeper::kNewMap, random_);
  for (const LandmarkRecord& r : many.landmarks) keeper.note(r);
  keeper.turn_once(at(0), {});
  keeper.turn_once(at(100), {});
  EXPECT_EQ(status(keeper).written, 0u);
  EXPECT_EQ(folder_.changes(), changes);

  folder_.set_user(std::nullopt);
  keeper.turn_once(at(102), {});
  EXPECT_FALSE(status(keeper).failing);
  EXPECT_EQ(status(keeper).place.view(), "session-1");
  EXPECT_EQ(stored().landmarks.size(), 30u) << "not left as another place's";
  EXPECT_EQ(stored("session-1").landmarks.size(), MapKeeper::kNewMap);
}

TEST_F(MapKeeperTest, AFolderThatWasLostToAnotherProgramIsNotWritten) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), {});
  EXPECT_EQ(status(keeper).written, 1u);
  folder_.set_user(storage::FolderUser{812, "zenithd", "bert"});
  const int changes = folder_.changes();
  keeper.note(own_.landmarks[1]);
  keeper.turn_once(at(6), {});
  keeper.finish(at(7), {});
  EXPECT_EQ(folder_.changes(), changes);
  EXPECT_TRUE(status(keeper).failing);
  EXPECT_NE(status(keeper).error.view().find("robot bert"), std::string_view::npos);
}

TEST_F(MapKeeperTest, AFolderThatCannotBeChangedIsReadAndToldOf) {
  store_a_map(30);
  folder_.put("session-1-0.zenmap", {1, 2, 3});
  folder_.set_read_only(true);
  MapKeeper keeper(folder_, own_.head, kInterval);
  EXPECT_EQ(keeper.load().size(), 1u) << "the robot may find itself in it";
  EXPECT_TRUE(status(keeper).failing);
  folder_.set_read_only(false);
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), {});
  EXPECT_FALSE(status(keeper).failing);
  EXPECT_TRUE(folder_.exists("session-1-0.zenmap.damaged")) << "not before it was this program's";
  EXPECT_EQ(stored("session-1").landmarks.size(), 1u);
}

TEST(MapFolder, LiesInTheStateFolderAndIsMadeThere) {
  EXPECT_EQ(map_folder("", "/state"), "");
  EXPECT_EQ(map_folder("/maps", ""), "/maps");
  EXPECT_EQ(map_folder("maps", ""), "") << "there is no state folder";
  EXPECT_EQ(map_folder(".", "/state"), "/state");
  const tools::TemporaryFolder state;
  const std::string here = state.path().string();
  ASSERT_TRUE(make_map_folder("left/maps", here).ok());
  ASSERT_TRUE(make_map_folder("left/maps", here).ok()) << "again";
  ASSERT_TRUE(make_map_folder(".", here).ok());
  storage::DiskFolder folder(map_folder("left/maps", here));
  EXPECT_TRUE(folder.lock(storage::this_program("ada")).ours());
  const auto permissions = std::filesystem::status(state.path() / "left").permissions();
  EXPECT_EQ(permissions & std::filesystem::perms::others_all, std::filesystem::perms::none);
  tools::write_text(state.path() / "file", "");
  const Status refused = make_map_folder("file/maps", here);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find(here + "/file/maps"), std::string::npos);
}

TEST_F(MapKeeperTest, AFullDiskIsToldOfUntilItIsNot) {
  MapKeeper keeper(folder_, own_.head, kInterval);
  keeper.load();
  folder_.set_full(true);
  keeper.note(own_.landmarks[0]);
  keeper.turn_once(at(0), {});
  EXPECT_TRUE(status(keeper).failing);
  EXPECT_NE(status(keeper).error.view().find("ENOSPC"), std::string_view::npos);
  folder_.set_full(false);
  keeper.turn_once(at(6), {});
  EXPECT_FALSE(status(keeper).failing);
  EXPECT_EQ(status(keeper).written, 1u);
  EXPECT_EQ(status(keeper).failed, 1u);
}

}  // namespace
}  // namespace zenith
