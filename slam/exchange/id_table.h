#pragma once
// Where a key stands: open addressing over memory that is at least half empty. The caller sees to
// it that no more keys are entered than the layout was told.

#include <bit>
#include <cassert>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"

namespace zenith::exchange {

class IdTable {
 public:
  void layout(Arena& arena, std::size_t keys) {
    buckets_ = arena.take<Bucket>(std::bit_ceil(2 * keys));
  }
  void clear() {
    for (Bucket& b : buckets_) b = {};
  }

  // -1: not there.
  std::int32_t find(std::uint64_t key) const { return buckets_[bucket(key)].value_and_one - 1; }
  void enter(std::uint64_t key, std::int32_t value) {
    Bucket& b = buckets_[bucket(key)];
    assert(b.value_and_one == 0);
    b = {key, value + 1};
  }
  // Those behind the hole move up, so that they are still found.
  void forget(std::uint64_t key) {
    std::size_t hole = bucket(key);
    assert(buckets_[hole].value_and_one != 0);
    for (std::size_t b = next(hole); buckets_[b].value_and_one != 0; b = next(b)) {
      const std::size_t home = home_of(buckets_[b].key);
      const bool reachable = ((b - home) & mask()) < ((b - hole) & mask());
      if (reachable) continue;
      buckets_[hole] = buckets_[b];
      hole = b;
    }
    buckets_[hole] = {};
  }

 private:
  struct Bucket {
    std::uint64_t key = 0;
    std::int32_t value_and_one = 0;  // 0: free
  };
  std::size_t mask() const { return buckets_.size() - 1; }
  std::size_t next(std::size_t b) const { return (b + 1) & mask(); }
  std::size_t home_of(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15U) >> 32u) & mask();
  }
  std::size_t bucket(std::uint64_t key) const {
    std::size_t b = home_of(key);
    while (buckets_[b].value_and_one != 0 && buckets_[b].key != key) b = next(b);
    return b;
  }

  std::span<Bucket> buckets_;
};

}  // namespace zenith::exchange
