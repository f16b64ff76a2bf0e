#include "platform/link/replay_window.h"

#include <set>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

TEST(ReplayWindow, NothingUpToItsBeginningIsNew) {
  ReplayWindow window;
  window.begin(5000);
  EXPECT_FALSE(window.is_new(5000));
  EXPECT_FALSE(window.is_new(4999));
  EXPECT_FALSE(window.is_new(1));
  EXPECT_TRUE(window.is_new(5001));
  window.note(5003);
  EXPECT_TRUE(window.is_new(5001));
  EXPECT_TRUE(window.is_new(5002));
  EXPECT_FALSE(window.is_new(5000));
  EXPECT_FALSE(window.is_new(5003));
}

TEST(ReplayWindow, WhatIsOlderThanItsWidthCountsAsSeen) {
  ReplayWindow window;
  window.begin(0);
  window.note(ReplayWindow::kWidth);
  EXPECT_TRUE(window.is_new(1));
  EXPECT_FALSE(window.is_new(0));
  window.note(ReplayWindow::kWidth + 1);
  EXPECT_FALSE(window.is_new(1));
  EXPECT_TRUE(window.is_new(2));
  window.note(1'000'000'000'000);
  EXPECT_FALSE(window.is_new(2));
  EXPECT_TRUE(window.is_new(999'999'999'999));
  EXPECT_FALSE(window.is_new(1'000'000'000'000));
}

TEST(ReplayWindow, EndsWithTheNumbers) {
  constexpr std::uint64_t kLast = ~std::uint64_t{0};
  ReplayWindow window;
  window.begin(kLast - 2);
  EXPECT_TRUE(window.is_new(kLast));
  window.note(kLast);
  EXPECT_FALSE(window.is_new(kLast));
  EXPECT_TRUE(window.is_new(kLast - 1));
}

// Against a set of all that was seen, over jumps of all sizes.
TEST(ReplayWindow, IsWhatASetWouldSay) {
  const TestSeed seed;
  Random random(seed.value());
  for (int run = 0; run < 20; ++run) {
    const std::uint64_t begin = random.below(3000);
    ReplayWindow window;
    window.begin(begin);
    std::set<std::uint64_t> seen;
    std::uint64_t newest = begin;
    for (int i = 0; i < 5000; ++i) {
      const std::uint64_t span = random.below(20) == 0 ? 3000 : 40;
      const std::uint64_t low = newest > 1500 ? newest - 1500 : 0;
      const std::uint64_t counter = random.below(2) == 0
                                        ? newest + random.below(static_cast<std::uint32_t>(span))
                                        : low + random.below(1510);
      const bool expected = counter > begin && seen.count(counter) == 0 &&
                            (counter > newest || newest - counter < ReplayWindow::kWidth);
      ASSERT_EQ(window.is_new(counter), expected) << counter << ", newest " << newest;
      if (!expected) continue;
      window.note(counter);
      seen.insert(counter);
      newest = std::max(newest, counter);
    }
  }
}

}  // namespace
}  // namespace zenith
