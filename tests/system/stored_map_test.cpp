// The map of a real daemon through kills: it is readable, and the next life finds itself in it.

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "platform/storage/map_store.h"
#include "tests/support/figure.h"
#include "tests/support/seeds.h"
#include "tests/system/sim_daemon.h"

namespace zenith {
namespace {

constexpr double kLimit_s = 120.0;  // what is waited for is a state

double stored(const SimDaemon& daemon, const char* key) {
  const auto line = daemon.latest("stored_map");
  return line.is_null() ? 0.0 : line[key].get<double>();
}

TEST(StoredMap, SurvivesKillsAndIsFoundAgain) {
  const TestSeed seed;
  Random random(seed.value(), 1);
  const tools::TemporaryFolder folder;
  const auto state = folder.path() / "state";
  std::filesystem::create_directory(state);
  // Lines behind the radio's, which has no key and stays off.
  SimDaemon daemon(folder.path(), "r1",
                   "[map]\nfolder = \"" + state.string() + "\"\ninterval_s = 1\n");
  ASSERT_TRUE(daemon.start());
  ASSERT_TRUE(listen_until({&daemon}, kLimit_s, [&] { return stored(daemon, "landmarks") > 120; }))
      << daemon.log();
  std::uint64_t checkpoint = 0;
  for (int life = 0; life < 3; ++life) {
    sleep_until(monotonic_now() + Duration::from_seconds(random.uniform()));
    daemon.kill();
    storage::DiskFolder disk(state.string());
    storage::MapStore store(disk);
    const storage::LoadedMap loaded = store.load();
    ASSERT_TRUE(loaded.map.has_value()) << "life " << life;
    EXPECT_TRUE(loaded.messages.empty()) << loaded.messages.front();
    EXPECT_GT(loaded.map->head.checkpoint, checkpoint) << "each life goes on writing";
    checkpoint = loaded.map->head.checkpoint;

    // The simulated robot begins at its first place again: there lies the origin of its map.
    ASSERT_TRUE(daemon.start());
    ASSERT_TRUE(listen_until({&daemon}, kLimit_s, [&] {
      const auto pose = daemon.latest("pose");
      return stored(daemon, "written") > 0 && !pose.is_null() && pose.contains("map_pose");
    })) << daemon.log();
    const auto pose = daemon.latest("pose");
    const double off_m =
        std::hypot(pose["map_pose"][0].get<double>() - pose["pose"][0].get<double>(),
                   pose["map_pose"][1].get<double>() - pose["pose"][1].get<double>());
    print_figure("stored map, life %d: %.0f landmarks loaded, found %.2f m from its true place",
                 life + 2, stored(daemon, "past_landmarks"), off_m);
    EXPECT_LT(off_m, 0.15);
    EXPECT_TRUE(daemon.logged("found itself in the stored map"));
  }
  EXPECT_EQ(daemon.stop(), 0);
}

}  // namespace
}  // namespace zenith
