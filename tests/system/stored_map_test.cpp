// The map of a real daemon through kills: it is readable, and the next life finds itself in it.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "platform/storage/map_store.h"
#include "tests/support/figure.h"
#include "tests/support/patience.h"
#include "tests/support/seeds.h"
#include "tests/system/sim_daemon.h"

namespace zenith {
namespace {

constexpr double kLimit_s = kPatience_s;  // what is waited for is a state

const std::filesystem::path kRoom = ZENITH_SOURCE_DIR "/tests/system/worlds/one-room.toml";

// The same room under another ceiling: nothing of the one is found in the other.
std::filesystem::path another_room(const std::filesystem::path& folder) {
  std::string text = tools::read_text(kRoom);
  const std::string seed = "seed = 7";
  text.replace(text.find(seed), seed.size(), "seed = 8");
  tools::write_text(folder / "another-room.toml", text);
  return folder / "another-room.toml";
}

class StoredMap : public testing::Test {
 protected:
  // The first life: until a map is on the disk.
  void map_the_room() {
    std::filesystem::create_directory(state_);
    ASSERT_TRUE(daemon_.start());
    ASSERT_TRUE(listen([&] { return stored("landmarks") > 120; })) << daemon_.log();
  }
  template <typename Holds>
  bool listen(Holds holds) {
    return listen_until({&daemon_}, kLimit_s, holds);
  }
  double stored(const char* key) const {
    const auto line = daemon_.latest("stored_map");
    return line.is_null() ? 0.0 : line[key].get<double>();
  }
  // Where the last checkpoint went.
  std::string place() const {
    const auto line = daemon_.latest("stored_map");
    return line.is_null() ? "" : line["place"];
  }
  double promoted() const {
    const auto line = daemon_.latest("health");
    return line.is_null() ? 0.0 : line["map"]["promoted"].get<double>();
  }
  storage::StoredMap on_disk(const std::string& name) const {
    storage::DiskFolder disk(state_.string());
    storage::MapStore store(disk, name);
    storage::LoadedMap loaded = store.load();
    EXPECT_TRUE(loaded.messages.empty()) << loaded.messages.front();
    return loaded.map ? std::move(*loaded.map) : storage::StoredMap{};
  }

  const TestSeed seed_;
  Random random_{seed_.value(), 1};
  const tools::TemporaryFolder folder_;
  const std::filesystem::path state_ = folder_.path() / "state";
  // Lines behind the radio's, which has no key and stays off.
  SimDaemon daemon_{folder_.path(), "r1",
                    "[map]\nfolder = \"" + state_.string() + "\"\ninterval_s = 1\n"};
};

TEST_F(StoredMap, KillsBeforeItFoundItselfCostNoneOfTheMaps) {
  map_the_room();
  daemon_.kill();
  const storage::StoredMap map = on_disk("map");
  const std::size_t before = map.landmarks.size();

  // It is carried into another room, and switched off twice before it has found anything there.
  daemon_.set_world(another_room(folder_.path()));
  const std::vector<std::string> sessions = {"session-1", "session-2"};
  std::size_t first = 0;
  for (const std::string& session : sessions) {
    ASSERT_TRUE(daemon_.start());
    ASSERT_TRUE(listen([&] { return promoted() > 40; }));
    // Two checkpoints later all of that must be on the disk: the first may have been under way.
    const double mapped = promoted();
    const double written = stored("written");
    ASSERT_TRUE(listen([&] { return stored("written") >= written + 2; }));
    const Time killed = monotonic_now() + Duration::from_seconds(random_.uniform());
    ASSERT_TRUE(listen([&] { return monotonic_now() > killed; }));
    daemon_.kill();
    const std::size_t kept = on_disk(session).landmarks.size();
    print_figure(
        "stored map, killed before it found itself: %zu landmarks kept, %.0f had been "
        "mapped two checkpoints before",
        kept, mapped);
    EXPECT_GE(static_cast<double>(kept), 0.9 * mapped);
    EXPECT_EQ(on_disk("map").landmarks.size(), before) << "it stays as it was";
    if (first == 0) first = kept;
  }

  // Let drive, it finds itself in the first of these sessions, which goes on.
  ASSERT_TRUE(daemon_.start());
  ASSERT_TRUE(listen([&] {
    return stored("landmarks") > 0 && stored("sessions") == 2 &&
           (place() == "session-1" || place() == "session-2");
  })) << daemon_.log();
  EXPECT_TRUE(daemon_.logged("found itself in the map of an earlier session"));
  daemon_.kill();
  EXPECT_EQ(on_disk("map").landmarks.size(), before);
  EXPECT_GT(std::max(on_disk("session-1").landmarks.size(), on_disk("session-2").landmarks.size()),
            first);

  // Back in its own room.
  daemon_.set_world(kRoom);
  ASSERT_TRUE(daemon_.start());
  ASSERT_TRUE(listen([&] { return place() == "map"; })) << daemon_.log();
  EXPECT_EQ(daemon_.stop(), 0);
  EXPECT_GE(on_disk("map").landmarks.size(), before);
  EXPECT_GT(on_disk("map").head.checkpoint, map.head.checkpoint);
}

TEST_F(StoredMap, SurvivesKillsAndIsFoundAgain) {
  map_the_room();
  std::uint64_t checkpoint = 0;
  for (int life = 0; life < 3; ++life) {
    sleep_until(monotonic_now() + Duration::from_seconds(random_.uniform()));
    daemon_.kill();
    const std::uint64_t now = on_disk("map").head.checkpoint;
    EXPECT_GT(now, checkpoint) << "each life goes on writing, life " << life;
    checkpoint = now;

    // The simulated robot begins at its first place again: there lies the origin of its map.
    ASSERT_TRUE(daemon_.start());
    ASSERT_TRUE(listen([&] {
      const auto pose = daemon_.latest("pose");
      return place() == "map" && !pose.is_null() && pose.contains("map_pose");
    })) << daemon_.log();
    const auto pose = daemon_.latest("pose");
    const double off_m =
        std::hypot(pose["map_pose"][0].get<double>() - pose["pose"][0].get<double>(),
                   pose["map_pose"][1].get<double>() - pose["pose"][1].get<double>());
    print_figure("stored map, life %d: %.0f landmarks loaded, found %.2f m from its true place",
                 life + 2, stored("past_landmarks"), off_m);
    EXPECT_LT(off_m, 0.15);
    EXPECT_TRUE(daemon_.logged("found itself in the stored map"));
  }
  EXPECT_EQ(daemon_.stop(), 0);
}

// A robot in a hall that its map does not show: after a thousand landmarks the map is given up.
// Then it comes to the place of that map. What it tells is in its own map's frame all the same.
TEST_F(StoredMap, OneThatWasLeftIsNoFrameWhenTheRobotComesToItsPlace) {
  const std::filesystem::path world = ZENITH_SOURCE_DIR "/tests/system/worlds/left-behind.toml";
  daemon_.set_world(world);
  map_the_room();
  ASSERT_EQ(daemon_.stop(), 0);
  const auto room = on_disk("map").head.map;

  SimDaemon robot(folder_.path(), "r2",
                  "[map]\nfolder = \"" + state_.string() + "\"\ninterval_s = 1\n");
  robot.set_world(world);
  ASSERT_TRUE(robot.start());
  // Its way: to the far end of the hall and back, into the room and around it. Metres from its
  // start.
  const std::vector<std::pair<bool, double>> stations = {
      {true, 40.0}, {false, 3.0}, {true, 8.4}, {false, 4.5}, {true, 8.0}};
  std::size_t station = 0;
  bool left = false;
  std::size_t after = 0;  // poses
  EXPECT_TRUE(listen_until({&robot}, kLimit_s,
                           [&] {
                             const auto map = robot.latest("stored_map");
                             const auto pose = robot.latest("pose");
                             if (map.is_null() || pose.is_null()) return false;
                             left = left || map["left"] == true;
                             EXPECT_FALSE(pose.contains("map_pose")) << "station " << station;
                             const double from_start_m = std::hypot(pose["pose"][0].get<double>(),
                                                                    pose["pose"][1].get<double>());
                             const auto& [beyond, distance_m] = stations[station];
                             if (beyond == (from_start_m > distance_m)) ++station;
                             if (station > 1) {
                               EXPECT_TRUE(left) << "before it comes to the room";
                               ++after;
                             }
                             return station == stations.size() || testing::Test::HasFailure();
                           }))
      << "station " << station << "\n"
      << robot.log();
  EXPECT_TRUE(left);
  EXPECT_GT(after, 0u);
  EXPECT_EQ(robot.stop(), 0);
  EXPECT_NE(on_disk("map").head.map, room) << "the hall's is the main one";
  EXPECT_TRUE(std::filesystem::exists(state_ / "map-0.zenmap.left"));
}

}  // namespace
}  // namespace zenith
