#include "slam/filter/ancestry.h"

#include <algorithm>
#include <cassert>

namespace zenith {

void Ancestry::layout(Arena& arena, int particles) {
  particles_ = particles;
  const auto n = static_cast<std::size_t>(particles);
  std::size_t count = 0;
  for (int level = 0; level < kLevels; ++level) count += kGenerations >> level;
  tables_ = arena.take<std::uint16_t>(count * n);
  composed_ = arena.take<std::uint16_t>(n);
}

// Blocks of one level lie side by side in a ring; the levels one after the other.
std::span<std::uint16_t> Ancestry::table(int level, std::uint32_t block) {
  std::size_t start = 0;
  for (int l = 0; l < level; ++l) start += kGenerations >> l;
  const auto n = static_cast<std::size_t>(particles_);
  return tables_.subspan((start + block % (kGenerations >> level)) * n, n);
}

void Ancestry::push(std::span<const std::uint16_t> parents) {
  assert(parents.size() == static_cast<std::size_t>(particles_));
  const auto newest = table(0, generation_);
  std::copy(parents.begin(), parents.end(), newest.begin());
  ++generation_;
  for (int level = 1; level < kLevels && generation_ % (1u << level) == 0; ++level) {
    const std::uint32_t block = (generation_ >> level) - 1;
    const auto older = table(level - 1, 2 * block);
    const auto newer = table(level - 1, 2 * block + 1);
    const auto both = table(level, block);
    for (std::size_t i = 0; i < both.size(); ++i) both[i] = older[newer[i]];
  }
}

std::span<const std::uint16_t> Ancestry::ancestors(std::uint32_t since) {
  assert(since <= generation_ && generation_ - since <= kGenerations);
  if (composed_valid_ && composed_since_ == since && composed_at_ == generation_) return composed_;
  for (std::size_t i = 0; i < composed_.size(); ++i) composed_[i] = static_cast<std::uint16_t>(i);
  std::uint32_t at = generation_;
  while (at > since) {
    int level = 0;
    while (level + 1 < kLevels && at % (2u << level) == 0 && at - since >= (2u << level)) ++level;
    const auto step = table(level, (at >> level) - 1);
    for (std::uint16_t& i : composed_) i = step[i];
    at -= 1u << level;
  }
  composed_since_ = since;
  composed_at_ = generation_;
  composed_valid_ = true;
  return composed_;
}

}  // namespace zenith
