#include "platform/linux/spsc_queue.h"

#include <cstdint>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(SpscQueue, KeepsOrderAndRejectsWhenFull) {
  SpscQueue<int, 4> queue;
  int out = -1;
  EXPECT_FALSE(queue.pop(out));
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(queue.push(10 * round + i));
    EXPECT_FALSE(queue.push(99));
    EXPECT_EQ(queue.size(), 4u);
    EXPECT_EQ(queue.rejected(), static_cast<std::uint64_t>(round + 1));
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(queue.pop(out));
      EXPECT_EQ(out, 10 * round + i);
    }
    EXPECT_FALSE(queue.pop(out));
    EXPECT_EQ(queue.size(), 0u);
  }
}

TEST(SpscQueue, APlaceThatIsFreedIsUsedAgain) {
  SpscQueue<int, 2> queue;
  int out = 0;
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.push(3));
  EXPECT_TRUE(queue.pop(out));
  EXPECT_TRUE(queue.push(3));
  EXPECT_TRUE(queue.pop(out));
  EXPECT_EQ(out, 2);
  EXPECT_TRUE(queue.pop(out));
  EXPECT_EQ(out, 3);
}

// An element whose halves must belong together.
struct Pair {
  std::uint64_t number = 0;
  std::uint64_t filler[6] = {};
  std::uint64_t inverse = 0;
};

TEST(SpscQueue, TwoThreadsLoseNothingAndTearNothing) {
  constexpr std::uint64_t kCount = 200'000;
  const auto queue = std::make_unique<SpscQueue<Pair, 64>>();
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      Pair pair;
      pair.number = i;
      pair.inverse = ~i;
      while (!queue->push(pair)) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t expected = 1; expected <= kCount;) {
    Pair pair;
    if (!queue->pop(pair)) {
      std::this_thread::yield();
      continue;
    }
    if (pair.number != expected || pair.inverse != ~expected) ++wrong;
    ++expected;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(queue->size(), 0u);
}

}  // namespace
}  // namespace zenith
