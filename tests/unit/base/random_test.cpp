#include "platform/base/random.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/seeds.h"

namespace zenith {
namespace {

// The first numbers of O'Neill's pcg32-demo, seed 42 and stream 54: ours is her generator.
TEST(Random, EqualsThePublishedPcg32) {
  Random random(42, 54);
  constexpr std::array<std::uint32_t, 6> kPublished = {0xa15c02b7, 0x7b47f409, 0xba1d3330,
                                                       0x83d2f293, 0xbfa4784b, 0xcbed606e};
  for (const std::uint32_t expected : kPublished) EXPECT_EQ(random.next_u32(), expected);
}

// Golden numbers, computed apart from this code: every machine draws the same. Uniforms are exact;
// normals go through the library's log, hence four units in the last place.
TEST(Random, DrawsTheSameNumbersOnEveryMachine) {
  Random uniform(1);
  constexpr std::array<double, 4> kUniform = {3795398737.0, 17903413.0, 3545275701.0, 194195274.0};
  for (const double x : kUniform) EXPECT_EQ(uniform.uniform(), x / 4294967296.0);
  Random normal(1);
  constexpr std::array<double, 5> kNormal = {1.8769064398259674, 2.1736407903713286,
                                             0.8159174293679992, 1.4153869470493883,
                                             1.1016962146511176};
  for (const double x : kNormal) EXPECT_DOUBLE_EQ(normal.normal(), x);
  Random below(1);
  constexpr std::array<std::uint32_t, 4> kBelow = {883, 4, 825, 45};
  for (const std::uint32_t x : kBelow) EXPECT_EQ(below.below(1000), x);
}

TEST(Random, SameSeedSameSequence) {
  const TestSeed seed;
  Random a(seed.value(), 3);
  Random b(seed.value(), 3);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a.normal(), b.normal()) << "draw " << i;
}

// 100 000 pairs of 32 bits: 50 % of the bits agree, with a standard deviation of 0.028 %. Five of
// them for each of the pairs of streams and seeds.
double agreeing_bits(Random a, Random b) {
  constexpr int kDraws = 100'000;
  std::int64_t agree = 0;
  for (int i = 0; i < kDraws; ++i) agree += 32 - __builtin_popcount(a.next_u32() ^ b.next_u32());
  return static_cast<double>(agree) / (32.0 * kDraws);
}

TEST(Random, StreamsAndSeedsAreIndependent) {
  const TestSeed seed;
  const std::uint64_t s = seed.value();
  constexpr double kTolerance = 5.0 * 0.00028;
  EXPECT_NEAR(agreeing_bits(Random(s, 0), Random(s, 1)), 0.5, kTolerance);
  EXPECT_NEAR(agreeing_bits(Random(s, 1), Random(s, 2)), 0.5, kTolerance);
  EXPECT_NEAR(agreeing_bits(Random(s), Random(s + 1)), 0.5, kTolerance);
}

// n draws in [0, 1): mean 1/2 with deviation sqrt(1/12n), variance 1/12 with sqrt(1/180n), each
// tenth holds n/10 with sqrt(0.09n). Five deviations: one false alarm in some 150 000 seeds.
TEST(Random, UniformIsUniform) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kDraws = 1'000'000;
  std::array<int, 10> bins = {};
  double sum = 0.0;
  double sum2 = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    ++bins[static_cast<std::size_t>(x * 10.0)];
    sum += x;
    sum2 += (x - 0.5) * (x - 0.5);
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kDraws));
  EXPECT_NEAR(sum2 / kDraws, 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / kDraws));
  for (const int bin : bins) EXPECT_NEAR(bin, kDraws / 10.0, 5.0 * std::sqrt(0.09 * kDraws));
}

// n normals: the mean has deviation 1/sqrt(n), the second moment sqrt(2/n), the third sqrt(15/n),
// the fourth (3) sqrt(96/n); beyond two sigma lie 4.55 %. Neighbours do not correlate: 1/sqrt(n).
TEST(Random, NormalIsNormal) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kDraws = 1'000'000;
  constexpr double kN = kDraws;
  std::array<double, 5> moment = {};
  double neighbours = 0.0;
  double previous = 0.0;
  int beyond = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    double power = 1.0;
    for (double& m : moment) {
      m += power;
      power *= x;
    }
    neighbours += x * previous;
    previous = x;
    beyond += std::abs(x) > 2.0 ? 1 : 0;
  }
  constexpr double kTail = 0.0455003;
  EXPECT_NEAR(moment[1] / kN, 0.0, 5.0 * std::sqrt(1.0 / kN));
  EXPECT_NEAR(moment[2] / kN, 1.0, 5.0 * std::sqrt(2.0 / kN));
  EXPECT_NEAR(moment[3] / kN, 0.0, 5.0 * std::sqrt(15.0 / kN));
  EXPECT_NEAR(moment[4] / kN, 3.0, 5.0 * std::sqrt(96.0 / kN));
  EXPECT_NEAR(neighbours / kN, 0.0, 5.0 * std::sqrt(1.0 / kN));
  EXPECT_NEAR(beyond / kN, kTail, 5.0 * std::sqrt(kTail * (1.0 - kTail) / kN));
}

TEST(Random, RangesAreKept) {
  const TestSeed seed;
  Random random(seed.value());
  std::array<int, 7> seen = {};
  for (int i = 0; i < 10'000; ++i) {
    const double x = random.uniform(-3.0, -1.0);
    ASSERT_GE(x, -3.0);
    ASSERT_LT(x, -1.0);
    const std::uint32_t n = random.below(7);
    ASSERT_LT(n, 7u);
    ++seen[n];
  }
  // 10 000 / 7 with a deviation of 35; five of them.
  for (const int count : seen) EXPECT_NEAR(count, 10'000.0 / 7.0, 5.0 * 35.0);
  EXPECT_EQ(random.below(1), 0u);
}

}  // namespace
}  // namespace zenith
