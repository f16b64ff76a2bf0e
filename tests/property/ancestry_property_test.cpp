// Ancestry and rows against brute force, over thousands of random resamplings.

#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "slam/filter/resample.h"
#include "slam/filter/rows.h"
#include "tests/support/arena_block.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

using Table = std::vector<std::uint16_t>;

// Anybody continues anybody, or the ordered outcome of a true resampling, or nothing changes.
Table random_parents(Random& random, std::size_t n) {
  Table parents(n);
  const std::uint32_t kind = random.below(3);
  if (kind == 0) {
    for (auto& p : parents)
      p = static_cast<std::uint16_t>(random.below(static_cast<std::uint32_t>(n)));
    return parents;
  }
  if (kind == 1) {
    for (std::size_t i = 0; i < n; ++i) parents[i] = static_cast<std::uint16_t>(i);
    return parents;
  }
  std::vector<double> weight(n);
  double sum = 0.0;
  for (double& w : weight) sum += w = -std::log(1.0 - random.uniform());
  for (double& w : weight) w /= sum;
  systematic_resample(weight, random.uniform(), parents);
  return parents;
}

// 5000 resamplings of 13 particles: the ring of 1024 goes round nearly five times. After each, the
// oldest generation that is still promised and a few random ones are compared with the composition
// of all tables, one by one.
TEST(AncestryProperty, EqualsComposingEveryTable) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr std::size_t kParticles = 13;
  Ancestry ancestry;
  const ArenaBlock block([&](Arena& arena) { ancestry.layout(arena, kParticles); });
  std::deque<Table> since;  // since[k]: ancestors at generation() - k, kept eagerly
  Table identity(kParticles);
  for (std::size_t i = 0; i < kParticles; ++i) identity[i] = static_cast<std::uint16_t>(i);
  since.push_front(identity);
  for (int g = 0; g < 5000; ++g) {
    const Table parents = random_parents(random, kParticles);
    ancestry.push(parents);
    for (Table& table : since) {
      Table next(kParticles);
      for (std::size_t i = 0; i < kParticles; ++i) next[i] = table[parents[i]];
      table = next;
    }
    since.push_front(identity);
    if (since.size() > Ancestry::kGenerations + 1) since.pop_back();
    for (int query = 0; query < 4; ++query) {
      const auto n = static_cast<std::uint32_t>(since.size());
      const std::uint32_t back = query == 0 ? n - 1 : random.below(n);
      const auto got = ancestry.ancestors(ancestry.generation() - back);
      ASSERT_TRUE(std::equal(got.begin(), got.end(), since[back].begin()))
          << "generation " << ancestry.generation() << ", " << back << " back";
    }
  }
}

// Rows that are brought up to date when touched equal rows that are copied at every resampling.
TEST(RowsProperty, LazyEqualsEager) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr int kParticles = 21;
  constexpr int kSlots = 30;
  constexpr int kRows = 3;
  RowStore<kRows> store;
  Ancestry ancestry;
  const ArenaBlock block([&](Arena& arena) {
    ancestry.layout(arena, kParticles);
    store.layout(arena, kSlots, kParticles);
  });
  std::vector<std::vector<float>> eager(kSlots * kRows, std::vector<float>(kParticles, 0.0F));
  std::vector<std::uint32_t> touched(kSlots, 0);
  for (int operation = 0; operation < 30'000; ++operation) {
    const auto slot = static_cast<int>(random.below(kSlots));
    const std::uint32_t what = random.below(10);
    if (what < 4) {
      const Table parents = random_parents(random, kParticles);
      ancestry.push(parents);
      for (auto& row : eager) {
        const auto old = row;
        for (std::size_t i = 0; i < kParticles; ++i) row[i] = old[parents[i]];
      }
      // As the owner must: nobody grows older than the ancestry remembers.
      for (int s = 0; s < kSlots; ++s) {
        if (ancestry.generation() - store.generation(s) >= Ancestry::kGenerations) {
          store.bring(s, ancestry);
        }
      }
      continue;
    }
    store.bring(slot, ancestry);
    for (int r = 0; r < kRows; ++r) {
      auto& expected = eager[static_cast<std::size_t>(slot * kRows + r)];
      float* row = store.row(slot, r);
      for (std::size_t i = 0; i < kParticles; ++i) {
        ASSERT_EQ(row[i], expected[i]) << "operation " << operation;
        if (what < 7) row[i] = expected[i] += static_cast<float>(random.uniform());
      }
    }
  }
}

// Counts within floor and ceiling of n w, order kept, for any weights and any pointer.
TEST(ResampleProperty, CountsAreFairAndOrderIsKept) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 3000; ++trial) {
    const std::size_t n = 1 + random.below(300);
    std::vector<double> weight(n);
    const double sharpness = random.uniform(0.0, 8.0);
    double sum = 0.0;
    for (double& w : weight) sum += w = std::exp(sharpness * random.normal());
    for (double& w : weight) w /= sum;
    Table parents(n);
    systematic_resample(weight, random.uniform(), parents);
    std::vector<int> count(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_LT(parents[i], n);
      if (i > 0) {
        ASSERT_GE(parents[i], parents[i - 1]) << "trial " << trial;
      }
      ++count[parents[i]];
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double fair = static_cast<double>(n) * weight[i];
      ASSERT_GE(count[i], static_cast<int>(std::floor(fair - 1e-9))) << "trial " << trial;
      ASSERT_LE(count[i], static_cast<int>(std::ceil(fair + 1e-9))) << "trial " << trial;
    }
  }
}

// Unbiased: over 20 000 pointers the mean count is n w, to five of its deviations (at most 1/2).
TEST(ResampleProperty, MeanCountIsTheWeight) {
  const TestSeed seed;
  Random random(seed.value());
  constexpr std::size_t kParticles = 7;
  const std::vector<double> weight = {0.02, 0.4, 0.08, 0.13, 0.27, 0.05, 0.05};
  std::vector<double> mean(kParticles, 0.0);
  constexpr int kTrials = 20'000;
  Table parents(kParticles);
  for (int trial = 0; trial < kTrials; ++trial) {
    systematic_resample(weight, random.uniform(), parents);
    for (const std::uint16_t p : parents) mean[p] += 1.0 / kTrials;
  }
  const double tolerance = 5.0 * 0.5 / std::sqrt(static_cast<double>(kTrials));
  for (std::size_t i = 0; i < kParticles; ++i) {
    EXPECT_NEAR(mean[i], kParticles * weight[i], tolerance) << i;
  }
}

}  // namespace
}  // namespace zenith
