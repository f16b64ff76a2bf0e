#include "platform/base/arena.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>

namespace zenith {
namespace {

struct Tables {
  std::span<std::uint8_t> bytes;
  std::span<double> doubles;

  void layout(Arena& arena) {
    bytes = arena.take<std::uint8_t>(3);
    doubles = arena.take<double>(100);
  }
};

struct alignas(Arena::kAlignment) Block {
  std::array<std::byte, 1024> bytes;
};

TEST(Arena, CountsWhatTheSameLayoutThenTakes) {
  Arena counting;
  Tables tables;
  tables.layout(counting);
  EXPECT_TRUE(counting.counting());
  EXPECT_TRUE(tables.bytes.empty());
  EXPECT_EQ(counting.used(), 64u + 832u) << "3 and 800 bytes, in whole cache lines";

  Block block;
  Arena arena(block.bytes);
  tables.layout(arena);
  EXPECT_FALSE(arena.counting());
  EXPECT_EQ(arena.used(), counting.used());
  EXPECT_EQ(tables.bytes.size(), 3u);
  EXPECT_EQ(tables.doubles.size(), 100u);
}

TEST(Arena, TellsATableWhatItCountsFor) {
  MemoryTable table;
  Arena counting(table);
  Tables tables;
  counting.part("tables");
  tables.layout(counting);
  counting.part("more");
  counting.take<std::uint8_t>(1);
  counting.part("tables");
  counting.take<std::uint8_t>(1);
  ASSERT_EQ(table.parts().size(), 2U);
  EXPECT_STREQ(table.parts()[0].name, "tables");
  EXPECT_EQ(table.parts()[0].bytes, 64U + 832U + 64U);
  EXPECT_EQ(table.parts()[1].bytes, 64U);
  EXPECT_EQ(table.total(), counting.used());
}

TEST(Arena, HandsOutAlignedZeroedArraysThatDoNotOverlap) {
  Block block;
  block.bytes.fill(std::byte{0xAB});
  Arena arena(block.bytes);
  Tables tables;
  tables.layout(arena);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(tables.bytes.data()) % Arena::kAlignment, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(tables.doubles.data()) % Arena::kAlignment, 0u);
  const auto zero = [](double x) { return x == 0.0; };
  EXPECT_TRUE(std::all_of(tables.doubles.begin(), tables.doubles.end(), zero));
  std::fill(tables.bytes.begin(), tables.bytes.end(), std::uint8_t{0xFF});
  EXPECT_TRUE(std::all_of(tables.doubles.begin(), tables.doubles.end(), zero));
}

TEST(ArenaDeathTest, RunningOutEndsTheProgramInEveryBuild) {
  Block block;
  Arena arena(block.bytes);
  EXPECT_DEATH(arena.take<double>(129), "too small");
  EXPECT_DEATH(Arena(std::span(block.bytes).subspan(8)), "not aligned");
}

}  // namespace
}  // namespace zenith
