#include "slam/exchange/budget.h"

#include <deque>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith::exchange {
namespace {

TEST(Budget, KeepsTheCapInAnySecond) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 20; ++trial) {
    const std::uint32_t cap = 5000 + random.below(200000);
    Budget budget;
    budget.configure(cap, 1228);
    std::deque<std::pair<std::int64_t, std::uint64_t>> window;
    std::uint64_t inside = 0;
    std::uint64_t all = 0;
    std::int64_t now = 0;
    for (int step = 0; step < 20000; ++step) {
      now += random.below(1000) == 0 ? random.below(2'000'000'000) : random.below(3'000'000);
      if (random.below(5000) == 0) budget.configure(cap, 1228 * (1 + random.below(20)));
      const std::uint32_t bytes = 60 + random.below(1168);
      if (!budget.spend(Time{now}, bytes)) continue;
      window.emplace_back(now, bytes);
      inside += bytes;
      all += bytes;
      while (now - window.front().first >= 1'000'000'000) {
        inside -= window.front().second;
        window.pop_front();
      }
      ASSERT_LE(inside, cap) << "trial " << trial << ", step " << step;
    }
    EXPECT_GT(static_cast<double>(all), 0.5 * cap);
  }
}

TEST(Budget, GivesAlmostTheCapOverTime) {
  Budget budget;
  budget.configure(100000, 1228);
  std::uint64_t all = 0;
  for (std::int64_t now = 0; now < 10'000'000'000; now += 1'000'000) {
    while (budget.spend(Time{now}, 1228)) all += 1228;
  }
  EXPECT_GT(all, 950000u);
}

TEST(Budget, SaysWhen) {
  Budget budget;
  budget.configure(10000, 2000);
  EXPECT_EQ(budget.when(Time{5}, 2000), Time{5});
  ASSERT_TRUE(budget.spend(Time{}, 2000));
  const Time when = budget.when(Time{}, 800);  // 8000 bytes a second flow
  EXPECT_EQ(when.ns, 100'000'000);
  EXPECT_FALSE(budget.spend(when - Duration{1000}, 800));
  EXPECT_TRUE(budget.spend(when, 800));
  EXPECT_GT(budget.when(when, 2001).ns, 3600'000'000'000) << "never";
}

}  // namespace
}  // namespace zenith::exchange
