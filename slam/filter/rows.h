#pragma once
// Per-particle values as rows: one array over the particles for each component, so that an update
// is one pass over a few rows. Rows remember the resampling generation at which they are valid.

#include <cassert>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "slam/capacity.h"
#include "slam/filter/ancestry.h"
#include "slam/kernels/rows/rows.h"

namespace zenith {

static_assert(kMaxParticles % kRowAlign == 0);

// Floats in a row for so many particles: kernels read and write the padding.
constexpr int row_stride(int particles) {
  return (particles + kRowAlign - 1) / kRowAlign * kRowAlign;
}

// `kRows` rows for each of a fixed number of slots.
template <int kRows>
class RowStore {
 public:
  void layout(Arena& arena, int slots, int particles) {
    particles_ = particles;
    stride_ = row_stride(particles);
    const auto n = static_cast<std::size_t>(slots);
    data_ = arena.take<float>(n * kRows * static_cast<std::size_t>(stride_));
    generation_ = arena.take<std::uint32_t>(n);
    scratch_ = arena.take<float>(static_cast<std::size_t>(stride_));
  }

  // Row `r` of a slot; the caller has brought it up to date.
  float* row(int slot, int r) { return data_.data() + offset(slot, r); }
  const float* row(int slot, int r) const { return data_.data() + offset(slot, r); }

  std::uint32_t generation(int slot) const { return generation_[static_cast<std::size_t>(slot)]; }
  void set_generation(int slot, std::uint32_t g) {
    generation_[static_cast<std::size_t>(slot)] = g;
  }

  // Makes the slot's rows valid at today's generation.
  void bring(int slot, Ancestry& ancestry) {
    const std::uint32_t since = generation(slot);
    if (since == ancestry.generation()) return;
    const auto from = ancestry.ancestors(since);
    for (int r = 0; r < kRows; ++r) {
      float* values = row(slot, r);
      for (int i = 0; i < particles_; ++i) {
        scratch_[static_cast<std::size_t>(i)] = values[from[static_cast<std::size_t>(i)]];
      }
      for (int i = 0; i < particles_; ++i) values[i] = scratch_[static_cast<std::size_t>(i)];
    }
    set_generation(slot, ancestry.generation());
  }

 private:
  std::size_t offset(int slot, int r) const {
    return (static_cast<std::size_t>(slot) * kRows + static_cast<std::size_t>(r)) *
           static_cast<std::size_t>(stride_);
  }

  int particles_ = 0;
  int stride_ = 0;
  std::span<float> data_;
  std::span<std::uint32_t> generation_;
  std::span<float> scratch_;
};

}  // namespace zenith
