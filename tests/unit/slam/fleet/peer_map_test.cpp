#include "slam/fleet/peer_map.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seeds.h"
#include "tests/unit/slam/fleet/fleet_world.h"

namespace zenith {
namespace {

using point_world::PeerRig;

LandmarkRecord record(std::uint32_t id, std::uint32_t revision, float x_m) {
  LandmarkRecord r;
  r.id = id;
  r.revision = revision;
  r.x_m = x_m;
  r.z_m = 2.5F;
  r.covariance_m2 = {0.01F, 0.001F, 0.0F, 0.01F, 0.0F, 0.02F};
  r.appearance_count = 1;
  r.appearances[0].descriptor[0] = 100;
  return r;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

TEST(PeerMap, KeepsWhatItIsTold) {
  PeerRig rig;
  EXPECT_TRUE(rig.map.empty());
  EXPECT_TRUE(rig.map.apply(record(7, 3, 1.5F)));
  ASSERT_EQ(rig.map.size(), 1);
  const PeerLandmark& l = rig.map[0];
  EXPECT_EQ(l.id, 7U);
  EXPECT_TRUE(l.present);
  EXPECT_EQ(l.xy(), Eigen::Vector2d(1.5, 0.0));
  EXPECT_EQ(l.covariance()(2, 2), static_cast<double>(0.02F));
  ASSERT_EQ(rig.map.looks(0).size(), 1U);
  EXPECT_NEAR(rig.map.looks(0)[0].compact.inverse_norm, 0.01F, 1e-6F);
}

TEST(PeerMap, RefusesWhatIsNoNumberOrAbsurd) {
  PeerRig rig;
  std::uint64_t refused = 0;
  const auto refuses = [&](auto&& change) {
    LandmarkRecord r = record(1, 1, 0.0F);
    change(r);
    EXPECT_FALSE(rig.map.apply(r));
    EXPECT_EQ(rig.map.rejected(), ++refused);
    EXPECT_TRUE(rig.map.empty());
  };
  for (const float bad : {kNan, kInfinite, -kInfinite, 1e6F}) {
    refuses([bad](LandmarkRecord& r) { r.x_m = bad; });
    refuses([bad](LandmarkRecord& r) { r.y_m = bad; });
    refuses([bad](LandmarkRecord& r) { r.z_m = bad; });
    for (std::size_t i = 0; i < 6; ++i) {
      refuses([bad, i](LandmarkRecord& r) { r.covariance_m2[i] = bad; });
    }
    refuses([bad](LandmarkRecord& r) { r.appearances[0].direction_rad = bad; });
  }
  for (const std::size_t variance : {0U, 3U, 5U}) {
    refuses([variance](LandmarkRecord& r) { r.covariance_m2[variance] = -1e-6F; });
  }
  refuses([](LandmarkRecord& r) { r.covariance_m2[1] = 0.011F; });  // correlation above one
  // Every two axes agree, the three together do not.
  refuses([](LandmarkRecord& r) { r.covariance_m2 = {1.0F, 0.9F, -0.9F, 1.0F, 0.9F, 1.0F}; });
  refuses([](LandmarkRecord& r) { r.appearance_count = kPublishedAppearances + 1; });
  EXPECT_TRUE(rig.map.apply(record(1, 1, 0.0F)));
}

TEST(PeerMap, ARefusedRecordLeavesTheOldOne) {
  PeerRig rig;
  rig.map.apply(record(1, 1, 2.0F));
  EXPECT_FALSE(rig.map.apply(record(1, 2, kNan)));
  EXPECT_EQ(rig.map[0].x_m, 2.0F);
  EXPECT_EQ(rig.map[0].revision, 1U);
}

TEST(PeerMap, RemovedLandmarksAreNotPresentAndMayReturn) {
  PeerRig rig;
  rig.map.apply(record(1, 1, 2.0F));
  LandmarkRecord removal = record(1, 2, 2.0F);
  removal.removed = true;
  rig.map.apply(removal);
  EXPECT_FALSE(rig.map[0].present);
  rig.map.apply(record(1, 1, 2.0F));  // late
  EXPECT_FALSE(rig.map[0].present);
  rig.map.apply(record(1, 3, 2.1F));
  EXPECT_TRUE(rig.map[0].present);
}

TEST(PeerMap, FullRejectsNewOnesAndUpdatesOldOnes) {
  PeerRig rig;
  for (std::uint32_t i = 0; i < kMaxPeerLandmarks; ++i) {
    ASSERT_TRUE(rig.map.apply(record(1000 * i + 7, 1, 0.5F)));  // ids that hash into a heap
  }
  EXPECT_FALSE(rig.map.apply(record(3, 1, 0.5F)));
  EXPECT_EQ(rig.map.rejected(), 1U);
  EXPECT_TRUE(rig.map.apply(record(7, 2, 0.75F)));
  EXPECT_EQ(rig.map[0].x_m, 0.75F);
  EXPECT_EQ(rig.map.size(), kMaxPeerLandmarks);
}

// Removed ones give their room to new ones; everybody else is still found.
TEST(PeerMap, FullOfRemovedOnesTakesNewOnes) {
  const TestSeed seed;
  Random random(seed.value());
  PeerRig rig;
  constexpr std::uint32_t kIds = 3 * kMaxPeerLandmarks;
  std::vector<std::uint32_t> present;
  std::uint32_t next = 0;
  const auto id_of = [](std::uint32_t n) { return n * 40503U + 1; };
  while (next < kIds) {
    ASSERT_TRUE(rig.map.apply(record(id_of(next), 1, 0.5F))) << next;
    present.push_back(next++);
    if (present.size() < kMaxPeerLandmarks) continue;
    for (int i = 0; i < 600; ++i) {
      std::swap(present[random.below(static_cast<std::uint32_t>(present.size()))], present.back());
      LandmarkRecord removal = record(id_of(present.back()), 2, 0.5F);
      removal.removed = true;
      ASSERT_TRUE(rig.map.apply(removal));
      present.pop_back();
    }
  }
  for (const std::uint32_t n : present) {
    ASSERT_TRUE(rig.map.apply(record(id_of(n), 7, 0.5F)));
  }
  std::size_t found = 0;
  for (int i = 0; i < rig.map.size(); ++i) {
    found += rig.map[i].present && rig.map[i].revision == 7 ? 1 : 0;
  }
  EXPECT_EQ(found, present.size());
  EXPECT_EQ(rig.map.rejected(), 0U);
}

// Two maps of one pool: what one gives back the other may have.
struct SharedPool {
  PeerLandmarkPool pool;
  std::array<PeerMap, kWholePeerMaps + 2> maps;
  ArenaBlock block{[this](Arena& arena) {
    pool.layout(arena);
    for (PeerMap& map : maps) map.layout(arena, pool);
  }};

  void fill(PeerMap& map, int landmarks) {
    for (int i = 0; i < landmarks; ++i) map.apply(record(static_cast<std::uint32_t>(i) + 1, 1, 0));
  }
};

TEST(PeerMap, APoolThatIsEmptyRejectsUntilSomebodyGivesBack) {
  SharedPool rig;
  const int half = kMaxPeerLandmarks / 2;
  for (PeerMap& map : rig.maps) rig.fill(map, &map == &rig.maps[0] ? half : kMaxPeerLandmarks);
  EXPECT_EQ(rig.pool.free_blocks(), 0U);
  PeerMap& last = rig.maps.back();
  EXPECT_EQ(last.size(), kPeerLandmarkPool - half - kWholePeerMaps * kMaxPeerLandmarks);
  EXPECT_EQ(last.rejected(), static_cast<std::uint64_t>(kMaxPeerLandmarks - last.size()));
  rig.maps[1].clear();
  EXPECT_TRUE(rig.maps[1].empty());
  EXPECT_EQ(rig.pool.free_blocks(), static_cast<std::size_t>(kMaxPeerLandmarks / kPeerBlock));
  EXPECT_TRUE(last.apply(record(kMaxPeerLandmarks, 1, 4.0F)));
  EXPECT_EQ(last[last.size() - 1].x_m, 4.0F);
  EXPECT_EQ(rig.maps[0][17].id, 18U) << "others keep theirs";
}

// Looks come, go and change their number; every landmark keeps its own.
TEST(PeerMap, LooksOfOneBlockAreTheirLandmarksOwn) {
  const TestSeed seed;
  Random random(seed.value());
  PeerRig rig;
  std::array<int, kPeerBlock> told = {};
  const auto direction = [](std::uint32_t id, int k) {
    return 0.01F * static_cast<float>(id) + 0.001F * static_cast<float>(k);
  };
  for (std::uint32_t revision = 1; revision <= 4000; ++revision) {
    const std::uint32_t id = random.below(kPeerBlock);
    LandmarkRecord r = record(id, revision, 0.5F);
    r.appearance_count = static_cast<std::uint8_t>(random.below(kPublishedAppearances + 1));
    for (int k = 0; k < r.appearance_count; ++k) {
      r.appearances[static_cast<std::size_t>(k)].descriptor[0] = 100;
      r.appearances[static_cast<std::size_t>(k)].direction_rad = direction(id, k);
    }
    told[id] = r.appearance_count;
    ASSERT_TRUE(rig.map.apply(r));
    int all = 0;
    for (int slot = 0; slot < rig.map.size(); ++slot) {
      const auto looks = rig.map.looks(slot);
      const std::uint32_t its_id = rig.map[slot].id;
      ASSERT_LE(static_cast<int>(looks.size()), told[its_id]);
      ASSERT_EQ(looks.empty(), told[its_id] == 0);
      for (std::size_t k = 0; k < looks.size(); ++k) {
        ASSERT_EQ(looks[k].direction_rad, direction(its_id, static_cast<int>(k)));
      }
      all += static_cast<int>(looks.size());
    }
    ASSERT_LE(all, kPeerBlockLooks);
  }
}

TEST(PeerMap, ABlockFullOfLooksStillGivesEachLandmarkItsFirst) {
  PeerRig rig;
  const auto tell = [&rig](std::uint32_t id, std::uint32_t revision, int looks) {
    LandmarkRecord r = record(id, revision, 0.5F);
    r.appearance_count = static_cast<std::uint8_t>(looks);
    EXPECT_TRUE(rig.map.apply(r));
    return rig.map.looks(static_cast<int>(id)).size();
  };
  std::size_t all = 0;
  for (std::uint32_t id = 0; id < kPeerBlock; ++id) {
    all += tell(id, 1, kPublishedAppearances);
    ASSERT_FALSE(rig.map.looks(static_cast<int>(id)).empty()) << id;
  }
  EXPECT_EQ(all, static_cast<std::size_t>(kPeerBlockLooks));
  EXPECT_EQ(tell(kPeerBlock - 1, 2, kPublishedAppearances), 1U);
  EXPECT_EQ(tell(0, 2, 1), 1U);
  EXPECT_EQ(tell(kPeerBlock - 1, 3, kPublishedAppearances), 7U) << "what another one gave up";
}

TEST(PeerMap, AClearedMapKnowsNothingOfBefore) {
  SharedPool rig;
  rig.maps[0].apply(record(5, 9, 1.0F));
  rig.maps[0].clear();
  EXPECT_TRUE(rig.maps[0].apply(record(5, 1, 2.0F)));  // an older revision: another map's
  ASSERT_EQ(rig.maps[0].size(), 1);
  EXPECT_EQ(rig.maps[0][0].x_m, 2.0F);
}

}  // namespace
}  // namespace zenith
