#include "slam/exchange/intervals.h"

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith::exchange {
namespace {

using Set = Intervals<4>;

std::string text(const Set& set) {
  std::string out;
  for (const Range& r : set.ranges()) {
    out += std::to_string(r.first) + "-" + std::to_string(r.last) + " ";
  }
  return out;
}

TEST(Intervals, JoinsWhatTouches) {
  Set set;
  set.add({5, 7});
  set.add({1, 2});
  EXPECT_EQ(text(set), "1-2 5-7 ");
  set.add({3, 3});
  EXPECT_EQ(text(set), "1-3 5-7 ");
  set.add({4, 4});
  EXPECT_EQ(text(set), "1-7 ");
  set.add({9, 12});
  set.add({6, 20});
  EXPECT_EQ(text(set), "1-20 ");
}

TEST(Intervals, RemovesFromTheMiddle) {
  Set set;
  set.add({1, 10});
  set.remove({4, 5});
  EXPECT_EQ(text(set), "1-3 6-10 ");
  set.remove({1, 1});
  set.remove({10, 99});
  EXPECT_EQ(text(set), "2-3 6-9 ");
  set.remove({0, 50});
  EXPECT_TRUE(set.empty());
}

TEST(Intervals, FullForgetsTheSmallest) {
  Set set;
  set.add({10, 19});
  set.add({30, 34});
  set.add({40, 40});
  set.add({50, 52});
  set.add({60, 61});
  EXPECT_EQ(text(set), "10-19 30-34 50-52 60-61 ");
  set.add({70, 70});  // it is the smallest itself
  EXPECT_EQ(text(set), "10-19 30-34 50-52 60-61 ");
  set.remove({14, 14});
  EXPECT_EQ(text(set), "10-13 15-19 30-34 50-52 ");
}

TEST(Intervals, FindsGaps) {
  Set set;
  set.add({3, 5});
  set.add({8, 9});
  Range gap;
  ASSERT_TRUE(set.first_gap({1, 20}, gap));
  EXPECT_EQ(gap, (Range{1, 2}));
  ASSERT_TRUE(set.first_gap({3, 20}, gap));
  EXPECT_EQ(gap, (Range{6, 7}));
  ASSERT_TRUE(set.first_gap({8, 20}, gap));
  EXPECT_EQ(gap, (Range{10, 20}));
  EXPECT_FALSE(set.first_gap({8, 9}, gap));
  EXPECT_FALSE(set.first_gap({4, 3}, gap));
}

TEST(Intervals, NeverClaimsMoreThanASetOfNumbers) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 300; ++trial) {
    Set set;
    std::array<bool, 64> truth = {};
    bool was_full = false;
    for (int step = 0; step < 60; ++step) {
      const std::uint32_t first = 1 + random.below(60);
      const std::uint32_t last = std::min(63u, first + random.below(6));
      const bool adds = random.below(3) != 0;
      adds ? set.add({first, last}) : set.remove({first, last});
      for (std::uint32_t x = first; x <= last; ++x) truth[x] = adds;
      was_full = was_full || set.ranges().size() == 4;
      for (std::uint32_t x = 1; x < 64; ++x) {
        if (set.contains(x)) {
          ASSERT_TRUE(truth[x]) << x;
        }
        if (!was_full) {
          ASSERT_EQ(set.contains(x), truth[x]) << x;
        }
      }
      for (std::size_t i = 1; i < set.ranges().size(); ++i) {
        ASSERT_GT(set.ranges()[i].first, set.ranges()[i - 1].last + 1);
      }
    }
  }
}

}  // namespace
}  // namespace zenith::exchange
