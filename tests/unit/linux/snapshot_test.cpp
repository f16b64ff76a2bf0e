#include "platform/linux/snapshot.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "platform/linux/triple_buffer.h"

namespace zenith {
namespace {

// A size that is no multiple of eight: the last word is filled in part.
struct Odd {
  std::uint32_t number = 0;
  char text[7] = {};
  bool operator==(const Odd&) const = default;
};

TEST(Snapshot, GivesBackTheLastValue) {
  Snapshot<Odd> snapshot;
  Odd out = {7, "before"};
  EXPECT_FALSE(snapshot.read(out));
  EXPECT_EQ(out, (Odd{7, "before"}));
  EXPECT_EQ(snapshot.version(), 0u);
  for (std::uint32_t i = 1; i < 4; ++i) {
    snapshot.write({i, "abcdef"});
    EXPECT_EQ(snapshot.version(), i);
    ASSERT_TRUE(snapshot.read(out));
    EXPECT_EQ(out, (Odd{i, "abcdef"}));
  }
}

// All elements hold the same number: a mixture of two values shows.
using Wide = std::array<std::uint64_t, 32>;

bool is_whole(const Wide& value) {
  for (const std::uint64_t word : value) {
    if (word != value[0]) return false;
  }
  return true;
}

Wide filled(std::uint64_t number) {
  Wide value;
  value.fill(number);
  return value;
}

constexpr std::uint64_t kWrites = 50'000;

TEST(Snapshot, ReadersNeverSeeAMixture) {
  Snapshot<Wide> snapshot;
  snapshot.write(filled(1));
  std::atomic<std::uint64_t> wrong = 0;
  const auto reader = [&] {
    std::uint64_t last = 0;
    while (last < kWrites) {
      Wide value = {};
      if (!snapshot.read(value) || !is_whole(value) || value[0] < last) ++wrong;
      if (value[0] == last) std::this_thread::yield();
      last = value[0];
    }
  };
  std::thread one(reader);
  std::thread two(reader);
  for (std::uint64_t i = 2; i <= kWrites; ++i) {
    snapshot.write(filled(i));
    if (i % 16 == 0) std::this_thread::yield();
  }
  one.join();
  two.join();
  EXPECT_EQ(wrong, 0u);
}

TEST(TripleBuffer, GivesTheNewestAndNothingTwice) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.fetch());
  EXPECT_EQ(buffer.front(), 0);
  for (int i = 1; i <= 10; ++i) {
    buffer.back() = i;
    buffer.publish();
    if (i % 3 != 0) continue;  // in between, values are overwritten
    EXPECT_TRUE(buffer.fetch());
    EXPECT_EQ(buffer.front(), i);
    EXPECT_FALSE(buffer.fetch());
    EXPECT_EQ(buffer.front(), i);
  }
}

TEST(TripleBuffer, TheReaderNeverSeesAMixture) {
  TripleBuffer<Wide> buffer;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kWrites; ++i) {
      buffer.back().fill(i);
      buffer.publish();
      if (i % 16 == 0) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  std::uint64_t last = 0;
  while (last < kWrites) {
    if (!buffer.fetch()) {
      std::this_thread::yield();
      continue;
    }
    if (!is_whole(buffer.front()) || buffer.front()[0] <= last) ++wrong;
    last = buffer.front()[0];
  }
  writer.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace zenith
