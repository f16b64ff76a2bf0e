#include "platform/linux/mpsc_queue.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(MpscQueue, KeepsOrderAndRejectsWhenFull) {
  MpscQueue<int, 4> queue;
  int out = -1;
  EXPECT_FALSE(queue.pop(out));
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(queue.push(10 * round + i));
    EXPECT_FALSE(queue.push(99));
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(queue.pop(out));
      EXPECT_EQ(out, 10 * round + i);
    }
    EXPECT_FALSE(queue.pop(out));
  }
}

struct Numbered {
  std::uint32_t thread = 0;
  std::uint32_t number = 0;
  std::uint64_t filler[4] = {};
  std::uint32_t check = 0;
};

TEST(MpscQueue, ManyThreadsLoseNothingAndEachKeepsItsOrder) {
  constexpr std::uint32_t kThreads = 4;
  constexpr std::uint32_t kEach = 20'000;
  MpscQueue<Numbered, 64> queue;
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&queue, t] {
      for (std::uint32_t i = 0; i < kEach; ++i) {
        Numbered item;
        item.thread = t;
        item.number = i;
        item.check = ~i;
        while (!queue.push(item)) std::this_thread::yield();
      }
    });
  }
  std::array<std::uint32_t, kThreads> next = {};
  std::uint32_t wrong = 0;
  for (std::uint32_t taken = 0; taken < kThreads * kEach;) {
    Numbered item;
    if (!queue.pop(item)) {
      std::this_thread::yield();
      continue;
    }
    if (item.number != next[item.thread] || item.check != ~item.number) ++wrong;
    next[item.thread] = item.number + 1;
    ++taken;
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace zenith
