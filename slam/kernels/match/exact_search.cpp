#include "slam/kernels/match/exact_search.h"

namespace zenith {
namespace {

template <typename T>
const T& at(const T* first, std::size_t stride, int i) {
  return *reinterpret_cast<const T*>(reinterpret_cast<const char*>(first) +
                                     static_cast<std::size_t>(i) * stride);
}

float exact_ncc(const MatchTable& table, const ExactQueries& queries, int query,
                const ExactLooks& looks, int look) {
  const auto offset = static_cast<std::size_t>(look) * looks.full_stride;
  const std::int32_t sum = table.full.dot(queries.full[query], looks.full + offset);
  return static_cast<float>(sum) * at(looks.inverse_norm, looks.full_stride, look) *
         queries.inverse_norm[query];
}

}  // namespace

void pack(const MatchTable& table, const std::int8_t* compact, const Outline& outline,
          const std::int8_t* full, float inverse_norm, ExactQueries& queries) {
  const int q = queries.compact.count;
  queries.rest[q] = outline.rest;
  queries.off[q] = outline.off;
  queries.full[q] = full;
  queries.inverse_norm[q] = inverse_norm;
  table.compact.pack(queries.compact, compact, outline.scale);
}

void two_best_exact(const MatchTable& table, const ExactQueries& queries, const ExactLooks& looks,
                    const std::int32_t* landmarks, int first_look, TwoBest* found) {
  const Looks compact = {looks.compact, &looks.outline->scale, looks.compact_stride, looks.count};
  TwoBest likely[kMaxQueries];
  table.compact.two_best(queries.compact, compact, landmarks, 0, likely);
  float known[kMaxQueries];
  for (int q = 0; q < queries.compact.count; ++q) {
    // Two landmarks have at least the lower of these: a runner-up is not below.
    known[q] = -1.0F;
    if (likely[q].second.look < 0) continue;
    const float one = exact_ncc(table, queries, q, looks, likely[q].best.look);
    const float other = exact_ncc(table, queries, q, looks, likely[q].second.look);
    known[q] = one < other ? one : other;
  }
  table.two_best_pruned(queries, looks, known, landmarks, first_look, found);
}

}  // namespace zenith
