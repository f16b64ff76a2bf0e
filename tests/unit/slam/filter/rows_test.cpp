#include "slam/filter/rows.h"

#include <array>

#include <gtest/gtest.h>

#include "tests/support/arena_block.h"

namespace zenith {
namespace {

TEST(Rows, StrideIsPaddedToARegister) {
  EXPECT_EQ(row_stride(1), kRowAlign);
  EXPECT_EQ(row_stride(kRowAlign), kRowAlign);
  EXPECT_EQ(row_stride(kRowAlign + 1), 2 * kRowAlign);
  EXPECT_EQ(row_stride(200), 208);
}

struct Rig {
  RowStore<2> store;
  Ancestry ancestry;
  ArenaBlock block{[this](Arena& arena) {
    store.layout(arena, 3, 4);
    ancestry.layout(arena, 4);
  }};
};

void fill(float* row, std::array<float, 4> values) {
  std::copy(values.begin(), values.end(), row);
}

std::array<float, 4> read(const float* row) {
  return {row[0], row[1], row[2], row[3]};
}

TEST(Rows, RowsAndSlotsDoNotOverlap) {
  Rig rig;
  for (int slot = 0; slot < 3; ++slot) {
    for (int r = 0; r < 2; ++r) {
      const auto v = static_cast<float>(10 * slot + r);
      fill(rig.store.row(slot, r), {v, v, v, v});
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(rig.store.row(slot, r)) % Arena::kAlignment, 0U);
    }
  }
  for (int slot = 0; slot < 3; ++slot) {
    for (int r = 0; r < 2; ++r) {
      EXPECT_EQ(rig.store.row(slot, r)[3], static_cast<float>(10 * slot + r));
    }
  }
}

TEST(Rows, BringFollowsTheAncestorsOnce) {
  Rig rig;
  fill(rig.store.row(1, 0), {0.0F, 1.0F, 2.0F, 3.0F});
  fill(rig.store.row(1, 1), {10.0F, 11.0F, 12.0F, 13.0F});
  rig.store.set_generation(1, 0);
  rig.ancestry.push(std::array<std::uint16_t, 4>{1, 1, 3, 3});
  rig.ancestry.push(std::array<std::uint16_t, 4>{0, 2, 2, 2});
  rig.store.bring(1, rig.ancestry);
  EXPECT_EQ(rig.store.generation(1), 2U);
  const std::array<float, 4> first = {1.0F, 3.0F, 3.0F, 3.0F};
  const std::array<float, 4> second = {11.0F, 13.0F, 13.0F, 13.0F};
  EXPECT_EQ(read(rig.store.row(1, 0)), first);
  EXPECT_EQ(read(rig.store.row(1, 1)), second);
  rig.store.bring(1, rig.ancestry);  // nothing new happened
  EXPECT_EQ(read(rig.store.row(1, 0)), first);
}

TEST(Rows, RowsWrittenTodayStay) {
  Rig rig;
  rig.ancestry.push(std::array<std::uint16_t, 4>{3, 3, 3, 3});
  fill(rig.store.row(0, 0), {0.0F, 1.0F, 2.0F, 3.0F});
  rig.store.set_generation(0, rig.ancestry.generation());
  rig.store.bring(0, rig.ancestry);
  EXPECT_EQ(rig.store.row(0, 0)[0], 0.0F);
}

}  // namespace
}  // namespace zenith
