// The specification of the matching kernels.

#include "slam/kernels/match/match.h"
#include "slam/kernels/match/match_two_best.h"

namespace zenith {
namespace {

template <int kLength>
std::int32_t dot(const std::int8_t* a, const std::int8_t* b) {
  std::int32_t sum = 0;
  for (int i = 0; i < kLength; ++i) sum += std::int32_t{a[i]} * std::int32_t{b[i]};
  return sum;
}

template <int kLength>
void pack(MatchQueries<kLength>& queries, const std::int8_t* values, float inverse_norm) {
  for (int i = 0; i < kLength; ++i) queries.values[queries.count * kLength + i] = values[i];
  queries.inverse_norm[queries.count++] = inverse_norm;
}

float look_norm(const Looks& looks, int look) {
  const auto offset = static_cast<std::size_t>(look) * looks.stride;
  return *reinterpret_cast<const float*>(reinterpret_cast<const char*>(looks.inverse_norm) +
                                         offset);
}

template <int kLength>
float ncc(const MatchQueries<kLength>& queries, int query, const Looks& looks, int look) {
  const std::int8_t* values = looks.values + static_cast<std::size_t>(look) * looks.stride;
  const std::int32_t sum = dot<kLength>(queries.values + query * kLength, values);
  return static_cast<float>(sum) * look_norm(looks, look) * queries.inverse_norm[query];
}

template <int kLength>
int best_of(const MatchQueries<kLength>& queries, const Looks& looks, float ncc_min,
            LookFound* found) {
  int count = 0;
  for (int q = 0; q < queries.count; ++q) {
    LookFound best = {q, -1, -1.0F};
    for (int i = 0; i < looks.count; ++i) {
      const float similarity = ncc(queries, q, looks, i);
      if (similarity > best.ncc) best = {q, i, similarity};
    }
    if (best.ncc >= ncc_min) found[count++] = best;
  }
  return count;
}

template <int kLength>
void two_best(const MatchQueries<kLength>& queries, const Looks& looks,
              const std::int32_t* landmarks, int first_look, TwoBest* found) {
  for (int q = 0; q < queries.count; ++q) {
    for (int i = 0; i < looks.count; ++i) {
      const float similarity = ncc(queries, q, looks, i);
      if (similarity > found[q].second.ncc) {
        take_if_better(q, first_look + i, landmarks[i], similarity, found[q]);
      }
    }
  }
}

template <int kLength>
constexpr MatchKernels<kLength> kernels() {
  return {pack<kLength>, best_of<kLength>, two_best<kLength>, dot<kLength>};
}

}  // namespace

const MatchTable kMatchScalar = {Isa::kScalar, kernels<32>(), kernels<256>()};

}  // namespace zenith
