#pragma once
// Who descends from whom, so that resampling need not copy the map.
//
// Each resampling is a table: parents[i] is the particle of the old generation that particle i of
// the new one continues. A row that was valid at generation g becomes valid now through the
// composition of all tables since g. Tables are kept for the last kGenerations resamplings, and
// composed over aligned blocks of 2, 4, 8, ... generations as they complete, so that any
// composition costs O(log kGenerations) look-ups a particle. Amortised, a resampling adds one
// composition. Rows must be brought up to date before they fall out (see Map::sweep).

#include <cstdint>
#include <span>

#include "platform/base/arena.h"

namespace zenith {

class Ancestry {
 public:
  static constexpr std::uint32_t kGenerations = 1024;

  void layout(Arena& arena, int particles);

  std::uint32_t generation() const { return generation_; }

  // A resampling: particle i continues parents[i]. The generation grows by one.
  void push(std::span<const std::uint16_t> parents);

  // table[i]: the particle of generation `since` that today's particle i continues.
  // `since` must not be older than generation() - kGenerations. Valid until the next call.
  std::span<const std::uint16_t> ancestors(std::uint32_t since);

 private:
  static constexpr int kLevels = 10;  // blocks of 1, 2, ..., 512
  std::span<std::uint16_t> table(int level, std::uint32_t block);

  int particles_ = 0;
  std::uint32_t generation_ = 0;
  std::span<std::uint16_t> tables_;
  std::span<std::uint16_t> composed_;
  std::uint32_t composed_since_ = 0;
  std::uint32_t composed_at_ = 0;
  bool composed_valid_ = false;
};

}  // namespace zenith
