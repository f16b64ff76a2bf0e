// Every instruction set that this processor has gives the same bits as the specification.
#include "slam/kernels/match/match.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/isas_here.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

// Patches as they stand in landmarks: something before, between and after them, at odd places.
template <int kLength>
struct Database {
  Database(int count, std::size_t distance, std::size_t begin) : stride(distance), offset(begin) {
    bytes.resize(offset + static_cast<std::size_t>(count + 1) * stride);
    norms.resize(bytes.size() / sizeof(float) + 1);
    landmarks.resize(static_cast<std::size_t>(count));
    looks.values = bytes.data() + offset;
    looks.inverse_norm = norms.data();
    looks.stride = stride;
    looks.count = count;
  }
  std::int8_t* patch(int i) { return bytes.data() + offset + static_cast<std::size_t>(i) * stride; }
  float& norm(int i) { return norms[static_cast<std::size_t>(i) * stride / sizeof(float)]; }

  std::size_t stride;
  std::size_t offset;
  std::vector<std::int8_t> bytes;
  std::vector<float> norms;
  std::vector<std::int32_t> landmarks;
  Looks looks;
};

// Random, all extremes, few different values (equal similarities), or nothing.
enum class Kind { kRandom, kExtreme, kFew, kZero };

template <int kLength>
void fill(Random& random, Kind kind, std::int8_t* values, float& norm) {
  double squares = 0.0;
  for (int i = 0; i < kLength; ++i) {
    int v = 0;
    if (kind == Kind::kRandom) v = static_cast<int>(random.uniform(-128.0, 128.0));
    if (kind == Kind::kExtreme) v = random.uniform(0.0, 1.0) < 0.8 ? -128 : 127;
    if (kind == Kind::kFew) v = i == static_cast<int>(random.uniform(0.0, 3.0)) ? 127 : 0;
    values[i] = static_cast<std::int8_t>(std::clamp(v, -128, 127));
    squares += v * v;
  }
  norm = squares > 0.0 ? static_cast<float>(1.0 / std::sqrt(squares)) : 0.0F;
}

template <int kLength>
struct Case {
  Case(Random& random, Kind kind, int queries, int looks) : database(looks, kLength + 4, 1) {
    own.resize(static_cast<std::size_t>(queries));
    own_norms.resize(own.size());
    for (std::size_t q = 0; q < own.size(); ++q) {
      own[q].resize(kLength);
      fill<kLength>(random, kind, own[q].data(), own_norms[q]);
    }
    for (int i = 0; i < looks; ++i) {
      // Some are much like a query.
      fill<kLength>(random, kind, database.patch(i), database.norm(i));
      if (kind == Kind::kRandom && queries > 0 && i % 3 == 0) {
        const auto q = static_cast<std::size_t>(random.uniform(0.0, queries - 0.001));
        std::memcpy(database.patch(i), own[q].data(),
                    kLength / 2 + static_cast<std::size_t>(i) % 16);
      }
      database.landmarks[static_cast<std::size_t>(i)] = i / 3;
    }
  }
  MatchQueries<kLength> packed(const MatchTable& table) const {
    MatchQueries<kLength> queries;
    for (std::size_t q = 0; q < own.size(); ++q) {
      kernels_of<kLength>(table).pack(queries, own[q].data(), own_norms[q]);
    }
    return queries;
  }
  std::vector<LookFound> best_of(const MatchTable& table, float ncc_min) const {
    std::vector<LookFound> found(own.size());
    const MatchQueries<kLength> queries = packed(table);
    const int count =
        kernels_of<kLength>(table).best_of(queries, database.looks, ncc_min, found.data());
    found.resize(static_cast<std::size_t>(count));
    return found;
  }
  std::vector<TwoBest> two_best(const MatchTable& table) const {
    std::vector<TwoBest> found(own.size());
    const MatchQueries<kLength> queries = packed(table);
    // In two parts, as maps come in blocks.
    Looks part = database.looks;
    part.count = database.looks.count / 2;
    kernels_of<kLength>(table).two_best(queries, part, database.landmarks.data(), 0, found.data());
    const int first = part.count;
    part.values += static_cast<std::size_t>(first) * part.stride;
    part.inverse_norm += static_cast<std::size_t>(first) * part.stride / sizeof(float);
    part.count = database.looks.count - first;
    kernels_of<kLength>(table).two_best(queries, part, database.landmarks.data() + first, first,
                                        found.data());
    return found;
  }

  std::vector<std::vector<std::int8_t>> own;
  std::vector<float> own_norms;
  Database<kLength> database;
};

bool same(const LookFound& a, const LookFound& b) {
  return a.query == b.query && a.look == b.look && std::memcmp(&a.ncc, &b.ncc, sizeof a.ncc) == 0;
}

template <typename Length>
class Match : public testing::Test {};
using Lengths = testing::Types<std::integral_constant<int, 32>, std::integral_constant<int, 256>>;
TYPED_TEST_SUITE(Match, Lengths);

TYPED_TEST(Match, EveryPathOfThisProcessorIsItsOwn) {
  for (const Isa isa : isas_here()) EXPECT_EQ(match_table(isa).isa, isa) << isa_name(isa);
}

TYPED_TEST(Match, EveryPathGivesTheBitsOfTheSpecification) {
  constexpr int kLength = TypeParam::value;
  const TestSeed seed;
  Random random(seed.value());
  int found_some = 0;
  for (const Kind kind : {Kind::kRandom, Kind::kExtreme, Kind::kFew, Kind::kZero}) {
    for (const int queries : {0, 1, 3, 4, 5, 8, 15, 16, 17, 31, 33, 60, 64, 100, 127, 128}) {
      for (const int looks : {0, 1, 2, 7, 20, 37}) {
        const Case<kLength> c(random, kind, queries, looks);
        for (const float ncc_min : {-0.5F, 0.0F, 0.4F}) {
          const auto expected = c.best_of(kMatchScalar, ncc_min);
          found_some += static_cast<int>(expected.size());
          for (const Isa isa : isas_here()) {
            const auto found = c.best_of(match_table(isa), ncc_min);
            ASSERT_TRUE(
                std::equal(found.begin(), found.end(), expected.begin(), expected.end(), same))
                << isa_name(isa) << ": " << queries << " queries, " << looks << " looks, kind "
                << static_cast<int>(kind);
          }
        }
        const auto expected = c.two_best(kMatchScalar);
        for (const Isa isa : isas_here()) {
          const auto found = c.two_best(match_table(isa));
          for (std::size_t q = 0; q < expected.size(); ++q) {
            ASSERT_TRUE(same(found[q].best, expected[q].best) &&
                        same(found[q].second, expected[q].second) &&
                        found[q].best_landmark == expected[q].best_landmark &&
                        found[q].second_landmark == expected[q].second_landmark)
                << isa_name(isa) << ": query " << q << " of " << queries << ", " << looks
                << " looks";
          }
        }
      }
    }
  }
  EXPECT_GT(found_some, 1000);
}

TYPED_TEST(Match, TheRunnerUpIsAnotherLandmarks) {
  constexpr int kLength = TypeParam::value;
  const TestSeed seed;
  Random random(seed.value());
  const Case<kLength> c(random, Kind::kRandom, 40, 300);
  for (const Isa isa : isas_here()) {
    for (const TwoBest& t : c.two_best(match_table(isa))) {
      EXPECT_NE(t.best_landmark, t.second_landmark);
      EXPECT_GE(t.best.ncc, t.second.ncc);
      EXPECT_EQ(t.best_landmark, t.best.look / 3);
      EXPECT_EQ(t.second_landmark, t.second.look / 3);
    }
  }
}

TYPED_TEST(Match, DotProductsAreExact) {
  constexpr int kLength = TypeParam::value;
  const TestSeed seed;
  Random random(seed.value());
  for (int round = 0; round < 200; ++round) {
    std::vector<std::int8_t> a(kLength + 1);
    std::vector<std::int8_t> b(kLength + 3);
    float ignored = 0.0F;
    const Kind kind = round % 2 == 0 ? Kind::kExtreme : Kind::kRandom;
    fill<kLength>(random, kind, a.data() + 1, ignored);
    fill<kLength>(random, kind, b.data() + 3, ignored);
    const std::int32_t expected = kernels_of<kLength>(kMatchScalar).dot(a.data() + 1, b.data() + 3);
    for (const Isa isa : isas_here()) {
      EXPECT_EQ(kernels_of<kLength>(match_table(isa)).dot(a.data() + 1, b.data() + 3), expected)
          << isa_name(isa);
    }
  }
}

}  // namespace
}  // namespace zenith
