#pragma once
// The pruned search over the operations of one instruction set (match_body.h), and the table of
// all. For the kernels' own files: see lanes.h.

#include "slam/kernels/match/exact_search.h"
#include "slam/kernels/match/match_body.h"

namespace zenith {
namespace {

template <typename Ops>
struct PrunedMatcher {
  using Compact = Matcher<Ops, 32>;
  static constexpr int kLanes = Ops::kLanes;
  using F = Floats<kLanes>;
  static constexpr int kLooksAtOnce = Compact::kLooksAtOnce;

  struct Search {
    const ExactQueries& queries;
    const ExactLooks& looks;
    const float* known;
    const std::int32_t* landmarks;
    int first_look;
    TwoBest* found;
    // What a bound must be above, less the query's `off`.
    alignas(64) float bars[kMaxQueries];

    ZENITH_INLINE void set_bar(int query) {
      // A look as good as what is known may be the runner-up.
      const float at_least = known[query] - 1e-6F;
      bars[query] = larger(found[query].second.ncc, at_least) - queries.off[query];
    }
  };

  struct Look {
    typename Compact::Words words;
    Outline outline;
  };
  static ZENITH_INLINE void prepare(const ExactLooks& looks, int i, Look& look) {
    const auto offset = static_cast<std::size_t>(i) * looks.compact_stride;
    Compact::prepare(looks.compact + offset, look.words);
    __builtin_memcpy(&look.outline, reinterpret_cast<const char*>(looks.outline) + offset,
                     sizeof(Outline));
  }

  // The bound is above the bar: how alike are they?
  static ZENITH_INLINE void examine(Search& search, int query, int i) {
    const ExactLooks& looks = search.looks;
    const Looks full = {looks.full, looks.inverse_norm, looks.full_stride, looks.count};
    const std::int32_t sum =
        Ops::template dot<256>(search.queries.full[query], Matcher<Ops, 256>::look_values(full, i));
    const float similarity = static_cast<float>(sum) * Matcher<Ops, 256>::look_norm(full, i) *
                             search.queries.inverse_norm[query];
    if (similarity <= search.found[query].second.ncc) return;
    take_if_better(query, search.first_look + i, search.landmarks[i], similarity,
                   search.found[query]);
    search.set_bar(query);
  }

  template <int kLooks, int kVectors>
  static ZENITH_INLINE void tile(Search& search, int vector, const Look* chunk, int first) {
    const auto& compact = search.queries.compact;
    typename Ops::Sums sums[kLooks][kVectors];
    const typename Compact::Words* words[kLooks];
    for (int l = 0; l < kLooks; ++l) words[l] = &chunk[l].words;
    Compact::template sum<kLooks, kVectors>(compact, vector, words, sums);
    for (int v = 0; v < kVectors; ++v) {
      const int at = (vector + v) * kLanes;
      const F scales = load<kLanes>(compact.inverse_norm + at);
      const F rests = load<kLanes>(search.queries.rest + at);
      for (int l = 0; l < kLooks; ++l) {
        const Outline& outline = chunk[l].outline;
        const F bound =
            Compact::ncc(sums[l][v], outline.scale, scales) + outline.rest * rests + outline.off;
        unsigned hits = Ops::above(bound, load<kLanes>(search.bars + at));
        for (; hits != 0; hits &= hits - 1) {
          examine(search, at + __builtin_ctz(hits), first + l);
        }
      }
    }
  }

  template <int kVectors>
  static ZENITH_INLINE void vectors(Search& search, int vector, const Look* chunk, int first,
                                    int count) {
    int look = 0;
    for (; look + kLooksAtOnce <= count; look += kLooksAtOnce) {
      tile<kLooksAtOnce, kVectors>(search, vector, chunk + look, first + look);
    }
    for (; look < count; ++look) tile<1, kVectors>(search, vector, chunk + look, first + look);
  }

  static void two_best_pruned(const ExactQueries& queries, const ExactLooks& looks,
                              const float* known, const std::int32_t* landmarks, int first_look,
                              TwoBest* found) {
    Search search = {queries, looks, known, landmarks, first_look, found, {}};
    const int count = queries.compact.count;
    const int all = (count + kLanes - 1) / kLanes;
    // Nothing is above 8: lanes without a query find nothing.
    for (int q = count; q < all * kLanes; ++q) search.bars[q] = 8.0F;
    for (int q = 0; q < count; ++q) search.set_bar(q);
    Look chunk[Compact::kLooksInChunk];
    for (int begin = 0; begin < looks.count; begin += Compact::kLooksInChunk) {
      const int left = looks.count - begin;
      const int here = left < Compact::kLooksInChunk ? left : Compact::kLooksInChunk;
      for (int i = 0; i < here; ++i) prepare(looks, begin + i, chunk[i]);
      int v = 0;
      for (; v + Ops::kVectors <= all; v += Ops::kVectors) {
        vectors<Ops::kVectors>(search, v, chunk, begin, here);
      }
      if (all - v == 3) vectors<3>(search, v, chunk, begin, here);
      if (all - v == 2) vectors<2>(search, v, chunk, begin, here);
      if (all - v == 1) vectors<1>(search, v, chunk, begin, here);
    }
  }
};

template <typename Ops>
constexpr MatchTable match_table_of(Isa isa) {
  return {isa, Matcher<Ops, 32>::kernels(), Matcher<Ops, 256>::kernels(),
          PrunedMatcher<Ops>::two_best_pruned};
}

}  // namespace
}  // namespace zenith
