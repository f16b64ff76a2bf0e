// The pruned search finds what a full scan finds, to the bit, on every instruction set.
#include "slam/kernels/match/exact_search.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "slam/image/patch.h"
#include "tests/support/isas_here.h"
#include "tests/support/seeds.h"
#include "tests/support/wave_patches.h"

namespace zenith {
namespace {

// Smooth as real ones, without any order, all values at their limits, few different ones (equal
// similarities).
enum class Kind { kWaves, kNoise, kExtreme, kFew };

Patch random_patch(Random& random, Kind kind) {
  if (kind == Kind::kWaves) return quantised(random_waves(random));
  PatchValues values;
  const auto which = static_cast<std::size_t>(random.below(4));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (kind == Kind::kNoise) values[i] = static_cast<float>(random.normal());
    if (kind == Kind::kExtreme) values[i] = random.below(2) == 0 ? -1.0F : 1.0F;
    if (kind == Kind::kFew) values[i] = i / 16 == which ? 1.0F : 0.0F;
  }
  return quantised(values);
}

struct Case {
  struct Entry {
    CompactPatch compact;
    Outline outline;
    Patch patch;
  };
  Case(Random& random, Kind kind, int query_count, int look_count) {
    for (int i = 0; i < look_count; ++i) {
      if (i % 50 == 17) {
        looks.push_back({});  // without contrast
      } else {
        looks.push_back(entry(random_patch(random, kind)));
      }
      landmarks.push_back(i / 3);
    }
    for (int q = 0; q < query_count; ++q) {
      Patch patch = random_patch(random, kind);
      // Some are what is looked for, a little changed.
      if (q % 2 == 0 && look_count > 0) {
        patch =
            looks[static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(look_count)))]
                .patch;
        for (std::size_t i = 0; i < 40; ++i) patch.values[i * 5] /= 2;
        patch = requantised(patch);
      }
      queries.push_back(entry(patch));
    }
  }
  static Entry entry(const Patch& patch) {
    Entry e;
    e.patch = patch;
    e.compact = compact(patch);
    e.outline = outline(patch, e.compact);
    return e;
  }
  std::vector<TwoBest> full_scan() const {
    MatchQueries<256> packed;
    for (const Entry& q : queries) {
      kMatchScalar.full.pack(packed, q.patch.values.data(), q.patch.inverse_norm);
    }
    std::vector<TwoBest> found(queries.size());
    if (looks.empty()) return found;
    const Looks all = {looks[0].patch.values.data(), &looks[0].patch.inverse_norm, sizeof(Entry),
                       static_cast<int>(looks.size())};
    kMatchScalar.full.two_best(packed, all, landmarks.data(), 0, found.data());
    return found;
  }
  std::vector<TwoBest> pruned(const MatchTable& table) const {
    ExactQueries packed;
    for (const Entry& q : queries) {
      pack(table, q.compact.values.data(), q.outline, q.patch.values.data(), q.patch.inverse_norm,
           packed);
    }
    std::vector<TwoBest> found(queries.size());
    // In two parts, as maps come in blocks.
    const int half = static_cast<int>(looks.size()) / 2;
    search(table, packed, 0, half, found);
    search(table, packed, half, static_cast<int>(looks.size()), found);
    return found;
  }
  void search(const MatchTable& table, const ExactQueries& packed, int begin, int end,
              std::vector<TwoBest>& found) const {
    if (begin == end) return;
    const Entry& first = looks[static_cast<std::size_t>(begin)];
    const ExactLooks part = {
        first.compact.values.data(), &first.outline, sizeof(Entry), first.patch.values.data(),
        &first.patch.inverse_norm,   sizeof(Entry),  end - begin};
    two_best_exact(table, packed, part, landmarks.data() + begin, begin, found.data());
  }

  std::vector<Entry> looks;
  std::vector<std::int32_t> landmarks;
  std::vector<Entry> queries;
};

bool same(const LookFound& a, const LookFound& b) {
  return a.query == b.query && a.look == b.look && std::memcmp(&a.ncc, &b.ncc, sizeof a.ncc) == 0;
}

TEST(ExactSearch, FindsWhatAFullScanFinds) {
  const TestSeed seed;
  Random random(seed.value());
  for (const Kind kind : {Kind::kWaves, Kind::kNoise, Kind::kExtreme, Kind::kFew}) {
    for (const int query_count : {0, 1, 7, 33, 100, 128}) {
      for (const int look_count : {0, 1, 2, 40, 301}) {
        const Case c(random, kind, query_count, look_count);
        const auto expected = c.full_scan();
        for (const Isa isa : isas_here()) {
          const auto found = c.pruned(match_table(isa));
          for (std::size_t q = 0; q < expected.size(); ++q) {
            ASSERT_TRUE(same(found[q].best, expected[q].best) &&
                        same(found[q].second, expected[q].second) &&
                        found[q].best_landmark == expected[q].best_landmark &&
                        found[q].second_landmark == expected[q].second_landmark)
                << isa_name(isa) << ": query " << q << " of " << query_count << ", " << look_count
                << " looks, kind " << static_cast<int>(kind);
          }
        }
      }
    }
  }
}

// The bound holds for every pair, and is of use: for smooth patches it is near.
TEST(ExactSearch, OutlinesBoundTheSimilarity) {
  const TestSeed seed;
  Random random(seed.value());
  double gap = 0.0;
  int pairs = 0;
  for (const Kind kind : {Kind::kWaves, Kind::kNoise, Kind::kExtreme, Kind::kFew}) {
    const Case c(random, kind, 60, 60);
    for (const Case::Entry& a : c.queries) {
      for (const Case::Entry& b : c.looks) {
        const auto products = [](const auto& x, const auto& y) {
          double sum = 0.0;
          for (std::size_t i = 0; i < x.size(); ++i) sum += static_cast<double>(x[i]) * y[i];
          return sum;
        };
        const double ncc = products(a.patch.values, b.patch.values) *
                           static_cast<double>(a.patch.inverse_norm * b.patch.inverse_norm);
        const double bound = products(a.compact.values, b.compact.values) *
                                 static_cast<double>(a.outline.scale * b.outline.scale) +
                             static_cast<double>(a.outline.rest * b.outline.rest) +
                             static_cast<double>(a.outline.off + b.outline.off);
        ASSERT_GE(bound, ncc);
        if (kind != Kind::kWaves || b.patch.inverse_norm == 0.0F) continue;
        gap += bound - ncc;
        ++pairs;
      }
    }
  }
  EXPECT_LT(gap / pairs, 0.15);
}

}  // namespace
}  // namespace zenith
