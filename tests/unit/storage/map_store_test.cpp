// Two generations on a disk that loses power, room or the right to be written.

#include "platform/storage/map_store.h"

#include <algorithm>
#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/faulty_folder.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tests/support/stored_maps.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::storage {
namespace {

TEST(MapStore, APowerCutAtAnyChangeLeavesTheLastCheckpoint) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const StoredMap small = random_map(60, random);
  const StoredMap large = random_map(900, random);  // several writes
  int cuts = 0;
  for (int round = 0; round < 6; ++round) {
    // Each run is cut one change later than the one before, until one gets through.
    for (int at = 0;; ++at) {
      FaultyFolder disk(seed.value() + static_cast<std::uint64_t>(1000 * round + at));
      std::uint64_t safe = 0;
      bool cut = false;
      // Three lives: what a cut has left is what the next one begins with.
      for (int life = 0; life < 3; ++life) {
        MapStore store(disk);
        const LoadedMap loaded = store.load();
        const std::uint64_t found = loaded.map ? loaded.map->head.checkpoint : 0;
        ASSERT_GE(found, safe) << "round " << round << ", cut at " << at << ", life " << life;
        EXPECT_LE(loaded.messages.size(), 0u) << loaded.messages.front();
        safe = found;
        disk.cut_after(at);
        for (int save = 0; save < 3; ++save) {
          StoredMap map = save == 1 ? large : small;
          const Status saved = store.save(map);
          if (!saved) break;
          safe = map.head.checkpoint;
        }
        cut = disk.is_cut();
        cuts += cut ? 1 : 0;
        disk.power_on();
      }
      if (!cut) break;
    }
  }
  EXPECT_GE(cuts, 200);
  print_figure("stored map: %d power cuts between writes, no unreadable map, none lost", cuts);
}

TEST(MapStore, AFullDiskKeepsWhatIsThere) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  FaultyFolder disk(seed.value());
  MapStore store(disk);
  StoredMap map = random_map(30, random);
  ASSERT_TRUE(store.save(map).ok());
  disk.set_full(true);
  EXPECT_FALSE(store.save(map).ok());
  EXPECT_EQ(disk.names(), std::vector<std::string>{"map-0.zenmap"}) << "no half file is left";
  disk.set_full(false);
  ASSERT_TRUE(store.save(map).ok());
  EXPECT_EQ(map.head.checkpoint, 2u);
  MapStore again(disk);
  EXPECT_EQ(again.load().map->head.checkpoint, 2u);
}

// The new names were not synced: whatever a cut leaves of them, the last checkpoint that was
// reported as written is found, also after a retry.
TEST(MapStore, AFolderThatDoesNotSyncCostsNoCheckpointThatWasReported) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  for (std::uint64_t cut = 0; cut < 64; ++cut) {
    FaultyFolder disk(seed.value() + cut);
    MapStore store(disk);
    StoredMap map = random_map(30, random);
    ASSERT_TRUE(store.save(map).ok());
    ASSERT_TRUE(store.save(map).ok());
    disk.fail_folder_sync(true);
    for (int tries = 0; tries < 3; ++tries) {
      EXPECT_FALSE(store.save(map).ok());
      EXPECT_EQ(map.head.checkpoint, 3u) << "none of them counts";
    }
    const std::vector<std::uint8_t> second = *disk.read("map-1.zenmap", kMaxMapBytes);
    EXPECT_EQ(decode_map(second).map.head.checkpoint, 2u) << "the good generation is left alone";
    disk.fail_folder_sync(false);
    if (cut % 2 == 0) {
      disk.power_on();
      MapStore again(disk);
      const LoadedMap loaded = again.load();
      ASSERT_TRUE(loaded.map.has_value()) << "cut " << cut;
      EXPECT_GE(loaded.map->head.checkpoint, 2u);
      EXPECT_THAT(loaded.messages, testing::IsEmpty());
    } else {
      ASSERT_TRUE(store.save(map).ok());
      disk.power_on();
      MapStore again(disk);
      EXPECT_EQ(again.load().map->head.checkpoint, 3u);
    }
  }
}

TEST(MapStore, AReadOnlyDiskIsRead) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  FaultyFolder disk(seed.value());
  StoredMap map = random_map(30, random);
  {
    MapStore store(disk);
    ASSERT_TRUE(store.save(map).ok());
  }
  disk.put("map-1.zenmap", {1, 2, 3});
  disk.set_read_only(true);
  MapStore store(disk);
  const LoadedMap loaded = store.load();
  ASSERT_TRUE(loaded.map.has_value());
  ASSERT_EQ(loaded.messages.size(), 2u);
  EXPECT_NE(loaded.messages[1].find("stays in its place"), std::string::npos);
  EXPECT_FALSE(store.save(map).ok());
  // When it can be written again, the bad one is still not overwritten.
  disk.set_read_only(false);
  ASSERT_TRUE(store.save(map).ok());
  EXPECT_TRUE(disk.exists("map-1.zenmap.damaged"));
}

TEST(MapStore, DamagedAndForeignOnesAreSetAsideUnderNamesOfTheirOwn) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  FaultyFolder disk(seed.value());
  MapStore store(disk);
  StoredMap map = random_map(30, random);
  ASSERT_TRUE(store.save(map).ok());
  ASSERT_TRUE(store.save(map).ok());
  std::vector<std::uint8_t> newer = encode_map(map);
  newer[8] = 2;
  disk.put("map-0.zenmap", newer);
  const auto damaged = encode_map(map);
  for (int i = 0; i < 2; ++i) {
    disk.put("map-1.zenmap", {damaged.begin(), damaged.end() - 5});
    MapStore again(disk);
    const LoadedMap loaded = again.load();
    EXPECT_FALSE(loaded.map.has_value());
    EXPECT_EQ(loaded.messages.size(), i == 0 ? 4u : 2u);
  }
  EXPECT_EQ(disk.names(), (std::vector<std::string>{"map-0.zenmap.foreign", "map-1.zenmap.damaged",
                                                    "map-1.zenmap.damaged-2"}));
}

TEST(MapStore, OnARealDiskAFullMapIsLoadedInTime) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const tools::TemporaryFolder folder;
  StoredMap map = random_map(kMaxStoredLandmarks, random);
  {
    DiskFolder disk(folder.path());
    MapStore store(disk);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(store.save(map).ok());
  }
  DiskFolder disk(folder.path());
  MapStore store(disk);
  const auto start = std::chrono::steady_clock::now();
  const LoadedMap loaded = store.load();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(loaded.map.has_value());
  EXPECT_EQ(loaded.map->head.checkpoint, 3u);
  EXPECT_EQ(loaded.map->landmarks.size(), kMaxStoredLandmarks);
  print_figure("stored map: two generations of %zu landmarks read in %.1f ms", kMaxStoredLandmarks,
               took.count() * 1e3);
  EXPECT_EQ(tools::entries(folder.path()), 2u);
}

TEST(MapStore, AFolderThatIsNotThereIsToldOf) {
  DiskFolder disk("/nowhere/at/all");
  MapStore store(disk);
  EXPECT_FALSE(store.load().map.has_value());
  StoredMap map;
  const Status saved = store.save(map);
  ASSERT_FALSE(saved.ok());
  EXPECT_NE(saved.error().message.find("ENOENT"), std::string::npos) << saved.error().message;
}

}  // namespace
}  // namespace zenith::storage
