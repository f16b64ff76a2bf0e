#pragma once
// How well descriptors recognise landmarks: each query look against one or several stored looks of
// every landmark of the sequence.
//
//   full     the patch made zero-mean, 256 values: NCC itself
//   DCT n    the first n coefficients of its DCT-II in zigzag order, without the constant one
//   sent     DCT 32 with stored looks as peers get them: 5 bits (slam/exchange/quantise.h)
//
// all others in int8 with an inverse norm, as the core keeps them (slam/image/patch.h).

#include <span>
#include <string>
#include <vector>

#include "slam/exchange/quantise.h"
#include "tools/descriptors/looks.h"

namespace zenith::tools {

inline constexpr int kFullLength = kPatchLength;

struct DescriptorKind {
  const char* name = "";
  int length = 0;         // values: kFullLength, or coefficients up to 120
  bool sent = false;      // stored looks have gone over the wire; queries are the robot's own
  std::size_t bytes = 0;  // of a stored look
};
inline constexpr DescriptorKind kComparedKinds[] = {
    {"full NCC", kFullLength, false, kFullLength},
    {"DCT 48", 48, false, 48},
    {"DCT 32", kCompactLength, false, kCompactLength},
    {"DCT 32 sent", kCompactLength, true, exchange::kLookBytes},
    {"DCT 24", 24, false, 24},
};

struct ComparisonSettings {
  int stored_looks = 1;       // of each landmark, at most; a further one only if it looks different
  int queries = 3;            // of each landmark, at most
  double threshold = 0.75;    // of the NCC: Parameters::ncc_overlap
  double apart_m = 0.5;       // a query is at least so far away from the stored look,
  double apart_rad = 0.5236;  // or turned by so much against it
  std::uint64_t seed = 1;
};

struct DescriptorScore {
  DescriptorKind kind;
  double rank1 = 0.0;         // queries whose most similar landmark is the right one
  double true_accept = 0.0;   // right pairs at or above the threshold
  double false_accept = 0.0;  // wrong ones
  double false_at_80 = 0.0;   // wrong ones accepted by the threshold that accepts 80 % right ones
};

struct Comparison {
  std::string sequence;
  std::string views;
  int landmarks = 0;  // that each query is compared with
  int queries = 0;
  double turned = 0.0;  // queries whose patch direction is off by more than 0.6 rad
  std::vector<DescriptorScore> scores;
};

// Stored and query looks of the same robot, and, with several robots, of different ones.
std::vector<Comparison> compare_descriptors(const LookSequence& sequence,
                                            const ComparisonSettings& settings);

// One descriptor of a patch; `length` kFullLength or a number of coefficients up to 120.
struct Descriptor {
  std::vector<std::int8_t> values;
  float inverse_norm = 0.0F;
};
Descriptor describe(const Patch& patch, int length);
// As a peer gets it; of kCompactLength values.
Descriptor sent(const Descriptor& descriptor);
float similarity(const Descriptor& a, const Descriptor& b);

}  // namespace zenith::tools
