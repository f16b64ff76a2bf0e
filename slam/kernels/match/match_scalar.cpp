// The specification of the matching kernels.

#include "slam/kernels/match/exact_search.h"
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

void two_best_pruned(const ExactQueries& queries, const ExactLooks& looks, const float* known,
                     const std::int32_t* landmarks, int first_look, TwoBest* found) {
  const Looks full = {looks.full, looks.inverse_norm, looks.full_stride, looks.count};
  for (int i = 0; i < looks.count; ++i) {
    const std::int8_t* compact = looks.compact + static_cast<std::size_t>(i) * looks.compact_stride;
    const Outline& outline =
        *reinterpret_cast<const Outline*>(reinterpret_cast<const char*>(looks.outline) +
                                          static_cast<std::size_t>(i) * looks.compact_stride);
    for (int q = 0; q < queries.compact.count; ++q) {
      const std::int32_t sum = dot<32>(queries.compact.values + q * 32, compact);
      const float bound =
          static_cast<float>(sum) * outline.scale * queries.compact.inverse_norm[q] +
          outline.rest * queries.rest[q] + outline.off + queries.off[q];
      if (bound <= found[q].second.ncc || bound < known[q]) continue;
      const std::int8_t* values = full.values + static_cast<std::size_t>(i) * full.stride;
      const float similarity = static_cast<float>(dot<256>(queries.full[q], values)) *
                               look_norm(full, i) * queries.inverse_norm[q];
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

const MatchTable kMatchScalar = {Isa::kScalar, kernels<32>(), kernels<256>(), two_best_pruned};

}  // namespace zenith
