#include "platform/base/time.h"

#include <type_traits>

#include <gtest/gtest.h>

namespace zenith {
namespace {

// A bare number is no time, and a time no duration.
static_assert(!std::is_convertible_v<Time, Duration>);
static_assert(!std::is_convertible_v<std::int64_t, Time>);
static_assert(Duration::from_seconds(0.1).ns == 100'000'000);

TEST(Time, DifferencesAreDurations) {
  const Time a = {5'000'000'000};
  const Time b = {5'250'000'000};
  EXPECT_EQ((b - a).ns, 250'000'000);
  EXPECT_EQ((a - b).ns, -250'000'000);
  EXPECT_EQ(a + (b - a), b);
  EXPECT_EQ(b - (b - a), a);
  EXPECT_EQ((Duration{1} + Duration{2}).ns, 3);
}

TEST(Time, IsOrdered) {
  EXPECT_LT(Time{1}, Time{2});
  EXPECT_GE(Time{2}, Time{2});
  EXPECT_LT(Duration{-1}, Duration{});
}

TEST(Duration, FromSecondsRoundsToTheNearestNanosecond) {
  EXPECT_EQ(Duration::from_seconds(1.4e-9).ns, 1);
  EXPECT_EQ(Duration::from_seconds(1.6e-9).ns, 2);
  EXPECT_EQ(Duration::from_seconds(-1.4e-9).ns, -1);
  EXPECT_EQ(Duration::from_seconds(-1.6e-9).ns, -2);
  EXPECT_EQ(Duration::from_seconds(0.0).ns, 0);
}

TEST(Duration, SecondsAndBackIsExactForDaysOfMicroseconds) {
  for (const std::int64_t us : {1LL, 999'999LL, 86'400'000'001LL, -86'400'000'001LL}) {
    const Duration d = {us * 1000};
    EXPECT_EQ(Duration::from_seconds(d.seconds()), d) << us << " us";
  }
}

}  // namespace
}  // namespace zenith
