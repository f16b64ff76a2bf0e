#include "slam/filter/ancestry.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/arena_block.h"

namespace zenith {
namespace {

constexpr int kParticles = 4;
using Table = std::array<std::uint16_t, kParticles>;

struct Rig {
  Ancestry ancestry;
  ArenaBlock block{[this](Arena& arena) { ancestry.layout(arena, kParticles); }};

  Table since(std::uint32_t generation) {
    const auto span = ancestry.ancestors(generation);
    Table out = {};
    std::copy(span.begin(), span.end(), out.begin());
    return out;
  }
};

constexpr Table kIdentity = {0, 1, 2, 3};

TEST(Ancestry, NobodyResampledIsHisOwnAncestor) {
  Rig rig;
  EXPECT_EQ(rig.ancestry.generation(), 0U);
  EXPECT_EQ(rig.since(0), kIdentity);
}

TEST(Ancestry, ComposesFromOldToNew) {
  Rig rig;
  rig.ancestry.push(Table{1, 1, 2, 3});
  rig.ancestry.push(Table{0, 2, 2, 3});
  rig.ancestry.push(Table{3, 0, 1, 1});
  EXPECT_EQ(rig.since(3), kIdentity);
  EXPECT_EQ(rig.since(2), (Table{3, 0, 1, 1}));
  EXPECT_EQ(rig.since(1), (Table{3, 0, 2, 2}));
  EXPECT_EQ(rig.since(0), (Table{3, 1, 2, 2}));
}

TEST(Ancestry, AnswersAnewAfterAPush) {
  Rig rig;
  rig.ancestry.push(Table{1, 0, 2, 3});
  EXPECT_EQ(rig.since(0), (Table{1, 0, 2, 3}));
  EXPECT_EQ(rig.since(0), (Table{1, 0, 2, 3}));
  rig.ancestry.push(Table{1, 0, 2, 3});
  EXPECT_EQ(rig.since(0), kIdentity);
}

// A permutation that cycles: after 4 n generations everybody is where he was, also at the far end
// of what is remembered and with the ring gone round several times.
TEST(Ancestry, RemembersAsFarAsItPromises) {
  Rig rig;
  constexpr Table kCycle = {1, 2, 3, 0};
  for (std::uint32_t g = 1; g <= 5 * Ancestry::kGenerations + 3; ++g) {
    rig.ancestry.push(kCycle);
    const std::uint32_t oldest = g < Ancestry::kGenerations ? 0 : g - Ancestry::kGenerations;
    const std::uint32_t turns = (g - oldest) % kParticles;
    const Table table = rig.since(oldest);
    for (std::uint32_t i = 0; i < kParticles; ++i) {
      ASSERT_EQ(table[i], (i + turns) % kParticles) << "generation " << g;
    }
  }
}

}  // namespace
}  // namespace zenith
