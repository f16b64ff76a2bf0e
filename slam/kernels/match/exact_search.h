#pragma once
// The best look and the runner-up of another landmark among whole patches, exactly as
// MatchKernels<256>::two_best() finds them, but most looks are ruled out by their compact form.
//
// A patch p of unit length is a multiple of its compact form c (of unit length, the quantised DCT
// coefficients) and a rest at right angles to it: p = share c + rest. Of the rest, `off` lies
// within the compact form's 32 frequencies: what quantisation moved. By Cauchy and Schwarz
//   NCC(a, b) <= share_a share_b ca.cb + |rest_a| |rest_b| + off_a + off_b
// Source of the idea: bounds from a part of an inner product, as in Teflioudi, Gemulla, "LEMP: fast
// retrieval of large entries in a matrix product", 2015.
//
// No heap, no state.

#include <cstddef>
#include <cstdint>

#include "slam/kernels/match/match.h"

namespace zenith {

// Of one patch; slam/image/patch.h makes it.
struct Outline {
  float scale = 0.0F;  // share / |int8 values of the compact form|
  float rest = 0.0F;
  float off = 0.0F;  // rounding included
};

// About 12 KiB. What `full` points to stays where it is during the search.
struct ExactQueries {
  MatchQueries<32> compact;  // with Outline::scale as inverse norm
  float rest[kMaxQueries] = {};
  float off[kMaxQueries] = {};
  const std::int8_t* full[kMaxQueries] = {};
  float inverse_norm[kMaxQueries] = {};
};

// The compact forms, with their outlines, and the whole patches: each kind `count` times, with its
// own stride in bytes.
struct ExactLooks {
  const std::int8_t* compact = nullptr;
  const Outline* outline = nullptr;
  std::size_t compact_stride = 0;
  const std::int8_t* full = nullptr;
  const float* inverse_norm = nullptr;
  std::size_t full_stride = 0;
  int count = 0;
};

void pack(const MatchTable& table, const std::int8_t* compact, const Outline& outline,
          const std::int8_t* full, float inverse_norm, ExactQueries& queries);

// `found[q]` goes on from what it was, as in two_best(). The compact forms are searched first: what
// is most alike there is most often the answer, and rules out nearly all others in a second pass.
void two_best_exact(const MatchTable& table, const ExactQueries& queries, const ExactLooks& looks,
                    const std::int32_t* landmarks, int first_look, TwoBest* found);

}  // namespace zenith
