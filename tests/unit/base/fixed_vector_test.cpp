#include "platform/base/fixed_vector.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace zenith {
namespace {

using Three = FixedVector<int, 3>;

TEST(FixedVector, FullIsANormalState) {
  Three v;
  EXPECT_TRUE(v.empty());
  EXPECT_TRUE(v.push_back(1));
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.full());
  EXPECT_TRUE(v.push_back(3));
  EXPECT_TRUE(v.full());
  EXPECT_FALSE(v.push_back(4)) << "rejects";
  EXPECT_EQ(v.size(), 3u);
  EXPECT_EQ(v[2], 3) << "what it holds is untouched";
  EXPECT_EQ(Three::capacity(), 3u);
}

TEST(FixedVector, SwapRemoveTakesTheLastToTheGap) {
  Three v;
  for (const int i : {1, 2, 3}) v.push_back(i);
  v.swap_remove(0);
  ASSERT_EQ(v.size(), 2u);
  EXPECT_EQ(v[0], 3);
  EXPECT_EQ(v[1], 2);
  v.swap_remove(1);
  ASSERT_EQ(v.size(), 1u);
  EXPECT_EQ(v[0], 3);
}

TEST(FixedVector, ShrinksAndClears) {
  Three v;
  for (const int i : {1, 2, 3}) v.push_back(i);
  v.shrink_to(1);
  EXPECT_EQ(v.size(), 1u);
  EXPECT_EQ(v.span().size(), 1u);
  v.clear();
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(v.begin(), v.end());
}

TEST(FixedVector, IsARange) {
  Three v;
  for (const int i : {3, 2, 1}) v.push_back(i);
  std::reverse(v.begin(), v.end());
  int expected = 1;
  for (const int i : v) EXPECT_EQ(i, expected++);
}

TEST(FixedVectorDeathTest, ReachingPastTheEndEndsTheProgramInEveryBuild) {
  Three v;
  v.push_back(1);
  EXPECT_DEATH(static_cast<void>(v[1]),
               "zenith: FixedVector: index beyond the end .*fixed_vector.h");
  EXPECT_DEATH(v.swap_remove(1), "no such element");
  EXPECT_DEATH(v.shrink_to(2), "cannot shrink");
}

}  // namespace
}  // namespace zenith
