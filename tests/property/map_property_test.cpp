// The map with lazy resampling against one that copies everything at once, under random operations.

#include <array>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "slam/filter/particles.h"
#include "slam/map/map.h"
#include "tests/support/arena_block.h"
#include "tests/support/point_world.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr int kParticles = 11;
using Row = std::array<float, kParticles>;

void follow(Row& row, const std::vector<std::uint16_t>& parents) {
  const Row old = row;
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = old[parents[i]];
}

struct EagerLandmark {
  std::uint32_t id = 0;
  int anchor = -1;
  std::array<Row, kLandmarkRows> rows;
  int looks = 0;
};

std::array<float*, kLandmarkRows> row_pointers(const LandmarkRows& r) {
  return {r.ax, r.ay, r.rho, r.pxx, r.pxy, r.pxr, r.pyy, r.pyr, r.prr};
}

class World {
 public:
  explicit World(std::uint64_t seed) : random_(seed) { map_.reset(); }

  void operate() {
    switch (random_.below(12)) {
      case 0:
        return add();
      case 1:
        return remove();
      case 2:
      case 3:
      case 4:
      case 5:
        return resample();
      case 6:
        return look();
      default:
        return touch();
    }
  }
  void check_all() {
    for (const auto& [slot, l] : landmarks_) check(slot, l);
    int looks = 0;
    for (const auto& [slot, l] : landmarks_) looks += l.looks;
    EXPECT_EQ(map_.size(), static_cast<int>(landmarks_.size()));
    EXPECT_EQ(map_.anchors_used(), static_cast<int>(anchors_.size()));
  }

 private:
  // Some landmarks at a new anchor.
  void add() {
    for (int i = 0; i < kParticles; ++i) {
      particles_.set_pose(
          i, {random_.uniform(-9.0, 9.0), random_.uniform(-9.0, 9.0), random_.uniform(-3.0, 3.0)});
    }
    place_cameras(particles_, {0.1, 0.0});
    const int anchor = map_.create_anchor(particles_.camera, PoseSensitivity::Zero());
    ASSERT_GE(anchor, 0);
    auto& rows = anchors_[anchor].rows;
    const CameraRows& c = particles_.camera;
    const float* from[] = {c.x, c.y, c.cos, c.sin};
    for (std::size_t r = 0; r < kAnchorRows; ++r) std::copy_n(from[r], kParticles, rows[r].begin());
    const std::uint32_t count = random_.below(4);
    for (std::uint32_t k = 0; k < count; ++k) {
      const int slot = map_.create(anchor);
      ASSERT_GE(slot, 0);
      ASSERT_FALSE(landmarks_.contains(slot));
      EagerLandmark& l = landmarks_[slot];
      l.id = map_.info(slot).id;
      l.anchor = anchor;
      ++anchors_[anchor].users;
      write(slot, l);
    }
    map_.release_if_unused(anchor);
    if (count == 0) anchors_.erase(anchor);
  }
  void remove() {
    if (landmarks_.empty()) return;
    const auto it = any();
    const int anchor = it->second.anchor;
    map_.remove(it->first);
    landmarks_.erase(it);
    if (--anchors_[anchor].users == 0) anchors_.erase(anchor);
  }
  void resample() {
    std::vector<std::uint16_t> parents(kParticles);
    for (auto& p : parents) p = static_cast<std::uint16_t>(random_.below(kParticles));
    map_.resampled(parents);
    for (auto& [slot, l] : landmarks_) {
      for (Row& row : l.rows) follow(row, parents);
    }
    for (auto& [slot, a] : anchors_) {
      for (Row& row : a.rows) follow(row, parents);
    }
  }
  void look() {
    if (landmarks_.empty()) return;
    const auto it = any();
    const bool added = map_.add_appearance(it->first, {}, {}, 0.0F);
    ASSERT_EQ(added, it->second.looks < kMaxAppearances);
    it->second.looks += added ? 1 : 0;
  }
  void touch() {
    if (landmarks_.empty()) return;
    const auto it = any();
    check(it->first, it->second);
    write(it->first, it->second);
  }
  void write(int slot, EagerLandmark& l) {
    const auto rows = row_pointers(map_.rows(slot));
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (std::size_t i = 0; i < kParticles; ++i) {
        rows[r][i] = l.rows[r][i] = static_cast<float>(random_.uniform());
      }
    }
  }
  void check(int slot, const EagerLandmark& l) {
    const LandmarkInfo& info = map_.info(slot);
    ASSERT_EQ(info.id, l.id);
    ASSERT_EQ(info.appearance_count, l.looks);
    const LandmarkRows rows = map_.rows(slot);
    const auto own = row_pointers(rows);
    const float* anchor[] = {rows.anchor_x, rows.anchor_y, rows.anchor_cos, rows.anchor_sin};
    for (std::size_t i = 0; i < kParticles; ++i) {
      for (std::size_t r = 0; r < own.size(); ++r) ASSERT_EQ(own[r][i], l.rows[r][i]);
      for (std::size_t r = 0; r < kAnchorRows; ++r) {
        ASSERT_EQ(anchor[r][i], anchors_[l.anchor].rows[r][i]);
      }
    }
  }
  std::map<int, EagerLandmark>::iterator any() {
    auto it = landmarks_.begin();
    std::advance(it, random_.below(static_cast<std::uint32_t>(landmarks_.size())));
    return it;
  }

  struct EagerAnchor {
    std::array<Row, kAnchorRows> rows;
    int users = 0;
  };
  Random random_;
  Map map_;
  Particles particles_;
  ArenaBlock block_{[this](Arena& arena) {
    map_.layout(arena, kParticles);
    particles_.layout(arena, kParticles);
  }};
  std::map<int, EagerLandmark> landmarks_;
  std::map<int, EagerAnchor> anchors_;
};

// 20 000 operations, of which a third are resamplings: the ring of generations goes round six
// times, and most landmarks are older than it remembers when they are looked at again.
TEST(MapProperty, LazyResamplingEqualsEagerCopying) {
  const TestSeed seed;
  const auto world = std::make_unique<World>(seed.value());
  for (int operation = 0; operation < 20'000; ++operation) {
    ASSERT_NO_FATAL_FAILURE(world->operate()) << "operation " << operation;
    if (operation % 4000 == 0) {
      ASSERT_NO_FATAL_FAILURE(world->check_all());
    }
  }
  ASSERT_NO_FATAL_FAILURE(world->check_all());
}

}  // namespace
}  // namespace zenith
