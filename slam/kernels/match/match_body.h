#pragma once
// The matching kernels over the operations of one instruction set. For the kernels' own files: see
// lanes.h.
//
// Queries lie side by side, kLanes of them in a vector, kStep values of each in a lane of 32 bits;
// vector v, step s: values + (v * steps + s) * 4 * kLanes. A look's values are prepared as one word
// of 32 bits for each step, which is multiplied with all lanes.
//
// Ops: kLanes, kStep, kVectors (with kLooks looks at a time), Sums;
//   query_word(values)       kStep values of a query, as a word
//   prepare<n>(values, to)   n values of a look, as words
//   kLookOffset              what prepare() adds to each value
//   broadcast(word's place), begin(starts), add(sums, queries, word), lanes(sums)
//   above(a, b)              a bit for each lane in which a > b

#include "slam/kernels/lanes.h"
#include "slam/kernels/match/match.h"
#include "slam/kernels/match/match_two_best.h"

namespace zenith {
namespace {

template <typename Ops, int kLength>
struct Matcher {
  static constexpr int kLanes = Ops::kLanes;
  static constexpr int kSteps = kLength / Ops::kStep;
  static constexpr int kVectorBytes = 4 * kLanes;
  static constexpr int kLooksAtOnce = 4;
  static_assert(Ops::kVectors <= 4);
  static constexpr int kLooksInChunk = 16;
  using F = Floats<kLanes>;
  using I = Ints<kLanes>;
  using Queries = MatchQueries<kLength>;

  static void pack(Queries& queries, const std::int8_t* values, float inverse_norm) {
    const int vector = queries.count / kLanes;
    const int lane = queries.count % kLanes;
    std::int8_t* to = queries.values + vector * kSteps * kVectorBytes + 4 * lane;
    for (int s = 0; s < kSteps; ++s, to += kVectorBytes) {
      const std::int32_t word = Ops::query_word(values + s * Ops::kStep);
      __builtin_memcpy(to, &word, 4);
    }
    std::int32_t sum = 0;
    for (int i = 0; i < kLength; ++i) sum += values[i];
    queries.start[queries.count] = Ops::kLookOffset * -sum;
    queries.inverse_norm[queries.count++] = inverse_norm;
  }

  static ZENITH_INLINE const std::int8_t* look_values(const Looks& looks, int i) {
    return looks.values + static_cast<std::size_t>(i) * looks.stride;
  }
  static ZENITH_INLINE float look_norm(const Looks& looks, int i) {
    float norm;
    __builtin_memcpy(&norm,
                     reinterpret_cast<const char*>(looks.inverse_norm) +
                         static_cast<std::size_t>(i) * looks.stride,
                     4);
    return norm;
  }

  // A look's words.
  struct alignas(16) Words {
    std::int8_t bytes[4 * kSteps];
  };
  static ZENITH_INLINE void prepare(const std::int8_t* values, Words& words) {
    Ops::template prepare<kLength>(values, words.bytes);
  }

  // The sums of kLooks looks with kVectors vectors of queries.
  template <int kLooks, int kVectors>
  static ZENITH_INLINE void sum(const Queries& queries, int vector,
                                const Words* const (&words)[kLooks],
                                typename Ops::Sums (&sums)[kLooks][kVectors]) {
    for (int v = 0; v < kVectors; ++v) {
      const auto start = Ops::begin(queries.start + (vector + v) * kLanes);
      for (int l = 0; l < kLooks; ++l) sums[l][v] = start;
    }
    const std::int8_t* q = queries.values + vector * kSteps * kVectorBytes;
#pragma GCC unroll 8
    for (int s = 0; s < kSteps; ++s) {
      typename Ops::Vector values[kVectors];
      for (int v = 0; v < kVectors; ++v) {
        values[v] = Ops::load_queries(q + (v * kSteps + s) * kVectorBytes);
      }
      for (int l = 0; l < kLooks; ++l) {
        const auto word = Ops::broadcast(words[l]->bytes + 4 * s);
        for (int v = 0; v < kVectors; ++v) sums[l][v] = Ops::add(sums[l][v], values[v], word);
      }
    }
  }

  static ZENITH_INLINE F ncc(const typename Ops::Sums& sums, float look_norm, const F& norms) {
    return __builtin_convertvector(Ops::lanes(sums), F) * look_norm * norms;
  }

  // --- the best of one landmark's looks ---

  template <int kVectors>
  static ZENITH_INLINE int best_of_vectors(const Queries& queries, int vector, const Looks& looks,
                                           float ncc_min, LookFound* found) {
    F best[kVectors];
    I which[kVectors];
    for (int v = 0; v < kVectors; ++v) {
      best[v] = F{} - 1.0F;
      which[v] = I{} - 1;
    }
    for (int i = 0; i < looks.count; ++i) {
      Words words;
      prepare(look_values(looks, i), words);
      typename Ops::Sums sums[1][kVectors];
      sum<1, kVectors>(queries, vector, {&words}, sums);
      for (int v = 0; v < kVectors; ++v) {
        const F norms = load<kLanes>(queries.inverse_norm + (vector + v) * kLanes);
        const F similarity = ncc(sums[0][v], look_norm(looks, i), norms);
        const auto better = similarity > best[v];
        best[v] = better ? similarity : best[v];
        which[v] = better ? I{} + i : which[v];
      }
    }
    int count = 0;
    for (int v = 0; v < kVectors; ++v) {
      unsigned below = Ops::above(F{} + ncc_min, best[v]);
      for (unsigned hits = ~below & ((1U << kLanes) - 1U); hits != 0; hits &= hits - 1) {
        const int lane = __builtin_ctz(hits);
        const int query = (vector + v) * kLanes + lane;
        if (query >= queries.count) break;
        found[count++] = {query, which[v][lane], best[v][lane]};
      }
    }
    return count;
  }

  static int best_of(const Queries& queries, const Looks& looks, float ncc_min, LookFound* found) {
    const int vectors = (queries.count + kLanes - 1) / kLanes;
    int count = 0;
    int v = 0;
    for (; v + 4 <= vectors; v += 4) {
      count += best_of_vectors<4>(queries, v, looks, ncc_min, found + count);
    }
    for (; v + 2 <= vectors; v += 2) {
      count += best_of_vectors<2>(queries, v, looks, ncc_min, found + count);
    }
    if (v < vectors) count += best_of_vectors<1>(queries, v, looks, ncc_min, found + count);
    return count;
  }

  // --- the two best of many landmarks' looks ---

  struct Chunk {
    const Words* words;
    const float* norms;
    const std::int32_t* landmarks;
    int first_look;
    int count;
  };

  template <int kLooks, int kVectors>
  static ZENITH_INLINE void two_best_tile(const Queries& queries, int vector, const Chunk& chunk,
                                          int look, float* seconds, TwoBest* found) {
    typename Ops::Sums sums[kLooks][kVectors];
    const Words* words[kLooks];
    for (int l = 0; l < kLooks; ++l) words[l] = chunk.words + look + l;
    sum<kLooks, kVectors>(queries, vector, words, sums);
    for (int v = 0; v < kVectors; ++v) {
      const int first = (vector + v) * kLanes;
      const F norms = load<kLanes>(queries.inverse_norm + first);
      for (int l = 0; l < kLooks; ++l) {
        const F similarity = ncc(sums[l][v], chunk.norms[look + l], norms);
        unsigned hits = Ops::above(similarity, load<kLanes>(seconds + first));
        for (; hits != 0; hits &= hits - 1) {
          const int lane = __builtin_ctz(hits);
          const int query = first + lane;
          take_if_better(query, chunk.first_look + look + l, chunk.landmarks[look + l],
                         similarity[lane], found[query]);
          seconds[query] = found[query].second.ncc;
        }
      }
    }
  }

  template <int kVectors>
  static ZENITH_INLINE void two_best_vectors(const Queries& queries, int vector, const Chunk& chunk,
                                             float* seconds, TwoBest* found) {
    int look = 0;
    for (; look + kLooksAtOnce <= chunk.count; look += kLooksAtOnce) {
      two_best_tile<kLooksAtOnce, kVectors>(queries, vector, chunk, look, seconds, found);
    }
    for (; look < chunk.count; ++look) {
      two_best_tile<1, kVectors>(queries, vector, chunk, look, seconds, found);
    }
  }

  static void two_best(const Queries& queries, const Looks& looks, const std::int32_t* landmarks,
                       int first_look, TwoBest* found) {
    const int vectors = (queries.count + kLanes - 1) / kLanes;
    alignas(64) float seconds[kMaxQueries];
    for (int q = 0; q < vectors * kLanes; ++q) {
      // Nothing is above NCC 2: lanes without a query find nothing.
      seconds[q] = q < queries.count ? found[q].second.ncc : 2.0F;
    }
    Words words[kLooksInChunk];
    float norms[kLooksInChunk];
    for (int begin = 0; begin < looks.count; begin += kLooksInChunk) {
      const int left = looks.count - begin;
      const int count = left < kLooksInChunk ? left : kLooksInChunk;
      for (int i = 0; i < count; ++i) {
        prepare(look_values(looks, begin + i), words[i]);
        norms[i] = look_norm(looks, begin + i);
      }
      const Chunk chunk = {words, norms, landmarks + begin, first_look + begin, count};
      int v = 0;
      for (; v + Ops::kVectors <= vectors; v += Ops::kVectors) {
        two_best_vectors<Ops::kVectors>(queries, v, chunk, seconds, found);
      }
      // What is left, together: single vectors would wait for their own sums.
      if (vectors - v == 3) two_best_vectors<3>(queries, v, chunk, seconds, found);
      if (vectors - v == 2) two_best_vectors<2>(queries, v, chunk, seconds, found);
      if (vectors - v == 1) two_best_vectors<1>(queries, v, chunk, seconds, found);
    }
  }

  static std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
    return Ops::template dot<kLength>(a, b);
  }

  static constexpr MatchKernels<kLength> kernels() {
    return {pack, best_of, two_best, dot};
  }
};

}  // namespace
}  // namespace zenith
