#include "platform/linux/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

TEST(LatencyHistogram, EmptyIsZero) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.percentile(0.5), Duration{});
  EXPECT_EQ(histogram.longest(), Duration{});
}

// The bin of one value alone: its percentiles show its upper edge, which longest() bounds.
TEST(LatencyHistogram, EveryBinHoldsItsValueToAnEighth) {
  for (std::int64_t ns = 0; ns < LatencyHistogram::kLongest.ns; ns += 1 + ns / 5) {
    LatencyHistogram histogram;
    histogram.add({ns});
    histogram.add({LatencyHistogram::kLongest.ns - 1});
    const std::int64_t edge = histogram.percentile(0.5).ns;
    ASSERT_GE(edge, ns);
    ASSERT_LE(static_cast<double>(edge - ns), static_cast<double>(ns) / 8.0) << ns;
  }
}

TEST(LatencyHistogram, ExtremesAreCounted) {
  LatencyHistogram histogram;
  histogram.add({-5});
  EXPECT_EQ(histogram.longest(), Duration{});
  histogram.add({INT64_MAX});
  EXPECT_EQ(histogram.count(), 2u);
  EXPECT_EQ(histogram.percentile(0.5), Duration{});
  EXPECT_EQ(histogram.percentile(1.0), Duration{INT64_MAX});
}

// Against the sorted list: never below the true percentile, and at most an eighth above.
TEST(LatencyHistogram, PercentilesAgreeWithTheSortedList) {
  const TestSeed seed;
  Random random(seed.value());
  LatencyHistogram histogram;
  std::vector<std::int64_t> all;
  for (int i = 0; i < 5000; ++i) {
    const auto ns = static_cast<std::int64_t>(std::exp(random.uniform(0.0, 24.0)));
    all.push_back(ns);
    histogram.add({ns});
  }
  std::sort(all.begin(), all.end());
  for (const double share : {0.001, 0.1, 0.5, 0.95, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * 5000.0)) - 1;
    const auto expected = static_cast<double>(all[rank]);
    const auto found = static_cast<double>(histogram.percentile(share).ns);
    EXPECT_GE(found, expected) << share;
    EXPECT_LE(found, expected * 1.125 + 1.0) << share;
  }
  EXPECT_EQ(histogram.longest().ns, all.back());
  EXPECT_EQ(histogram.percentile(1.0).ns, all.back());
}

TEST(LatencyHistogram, MergesLikeOneThatSawAll) {
  LatencyHistogram left;
  LatencyHistogram right;
  LatencyHistogram all;
  for (std::int64_t i = 0; i < 100; ++i) {
    (i % 3 == 0 ? left : right).add({i * i * 1000});
    all.add({i * i * 1000});
  }
  left.merge(right);
  EXPECT_EQ(left.count(), 100u);
  EXPECT_EQ(left.text(), all.text());
  left.clear();
  EXPECT_EQ(left.count(), 0u);
  EXPECT_EQ(left.longest(), Duration{});
}

TEST(LatencyHistogram, CopiesAreTheirOwn) {
  LatencyHistogram one;
  one.add({5});
  LatencyHistogram two(one);
  two.add({6});
  EXPECT_EQ(one.count(), 1u);
  EXPECT_EQ(two.count(), 2u);
  one = two;
  EXPECT_EQ(one.longest(), Duration{6});
}

TEST(LatencyHistogram, ReadsWell) {
  LatencyHistogram histogram;
  for (int i = 0; i < 99; ++i) histogram.add({1'000'000});
  histogram.add({4'200'000});
  EXPECT_EQ(histogram.text(),
            "100 times, median 1.05 ms, 95 % 1.05 ms, 99.9 % 4.2 ms, longest 4.2 ms");
}

TEST(DurationText, HasThreeDigitsAndAUnit) {
  EXPECT_EQ(duration_text({0}), "0 ns");
  EXPECT_EQ(duration_text({950}), "950 ns");
  EXPECT_EQ(duration_text({12'540}), "12.5 us");
  EXPECT_EQ(duration_text({999'999}), "1 ms");
  EXPECT_EQ(duration_text({-3'210'000}), "-3.21 ms");
  EXPECT_EQ(duration_text(Duration::from_seconds(1.5)), "1.5 s");
  EXPECT_EQ(duration_text(Duration::from_seconds(7200)), "7200 s");
}

}  // namespace
}  // namespace zenith
