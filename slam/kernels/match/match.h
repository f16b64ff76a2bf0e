#pragma once
// Normalised cross correlation of many patches against many (paper III-A).
//
// A patch is kLength int8 values and an inverse norm; a patch without contrast has the inverse norm
// 0 and is similar to nothing. NCC(query, look) = float(sum of products) * look's inverse norm *
// query's inverse norm, in this order. The sums are exact for all int8 values, -128 included, so
// that every instruction set gives the same bits.
//
// Queries are what many looks are compared with: the corners of a frame. They are packed once, the
// way the instruction set wants them. Looks are read where they stand.
//
// No heap, no state; any thread, as long as nobody packs the queries meanwhile.

#include <cstddef>
#include <cstdint>

#include "platform/base/isa.h"

namespace zenith {

inline constexpr int kMaxQueries = 128;

// Packed by the table that also reads them. About 9 KiB for 32 values, 65 KiB for 256.
template <int kLength>
struct MatchQueries {
  int count = 0;
  alignas(64) std::int8_t values[2 * kMaxQueries * kLength] = {};
  // What sums begin with, where values of looks are made unsigned.
  alignas(64) std::int32_t start[kMaxQueries] = {};
  alignas(64) float inverse_norm[kMaxQueries] = {};
};

// `count` patches, one every `stride` bytes. Nothing needs to be aligned, but for the floats.
struct Looks {
  const std::int8_t* values = nullptr;
  const float* inverse_norm = nullptr;
  std::size_t stride = 0;
  int count = 0;
};

struct LookFound {
  int query = -1;
  int look = -1;
  float ncc = -1.0F;
};

// A query's most similar look, and the most similar look of another landmark. -1: none yet.
struct TwoBest {
  LookFound best;
  LookFound second;
  std::int32_t best_landmark = -1;
  std::int32_t second_landmark = -1;
};

template <int kLength>
struct MatchKernels {
  // Adds a query at queries.count, which must be below kMaxQueries.
  void (*pack)(MatchQueries<kLength>& queries, const std::int8_t* values, float inverse_norm);

  // The looks of one landmark: for every query with an NCC of at least `ncc_min` (above -1) the
  // most similar look, the first of equal ones. In the order of the queries; returns how many.
  // `found` has room for queries.count.
  int (*best_of)(const MatchQueries<kLength>& queries, const Looks& looks, float ncc_min,
                 LookFound* found);

  // The looks of many landmarks, `landmarks[i]` being that of look i, not below 0. `found[q]` goes
  // on from what it was, with `first_look` as the number of the first look. Equal ones: the earlier
  // wins.
  void (*two_best)(const MatchQueries<kLength>& queries, const Looks& looks,
                   const std::int32_t* landmarks, int first_look, TwoBest* found);

  // The sum of products of two patches.
  std::int32_t (*dot)(const std::int8_t* a, const std::int8_t* b);
};

struct ExactQueries;  // exact_search.h
struct ExactLooks;

struct MatchTable {
  Isa isa;
  MatchKernels<32> compact;  // DCT coefficients
  MatchKernels<256> full;    // 16 x 16 pixels

  // The second pass of two_best_exact(): the two best of the looks that have at least the NCC
  // `known[q]`; of the others, any may be left out.
  void (*two_best_pruned)(const ExactQueries& queries, const ExactLooks& looks, const float* known,
                          const std::int32_t* landmarks, int first_look, TwoBest* found);
};

// Of the best instruction set not above `isa`, and of the one in use (isa_in_use.h).
const MatchTable& match_table(Isa isa);
const MatchTable& match_in_use();

template <int kLength>
constexpr const MatchKernels<kLength>& kernels_of(const MatchTable& table) {
  if constexpr (kLength == 32) {
    return table.compact;
  } else {
    return table.full;
  }
}

// One file each, where the compiler builds for it.
extern const MatchTable kMatchScalar;
extern const MatchTable kMatchSse41;
extern const MatchTable kMatchAvx2;
extern const MatchTable kMatchAvx512;
extern const MatchTable kMatchNeon;
extern const MatchTable kMatchNeonDotprod;

}  // namespace zenith
