#pragma once
// Where a key stands: open addressing over memory that is at least half empty. The table holds the
// places alone; `key_of(place)` tells the key of what stands there. The caller sees to it that no
// more keys are entered than the layout was told.

#include <bit>
#include <cassert>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"

namespace zenith::exchange {

class IdTable {
 public:
  void layout(Arena& arena, std::size_t keys) {
    buckets_ = arena.take<std::int32_t>(std::bit_ceil(2 * keys));
  }
  void clear() {
    for (std::int32_t& b : buckets_) b = 0;
  }

  // -1: not there.
  template <typename KeyOf>
  std::int32_t find(std::uint64_t key, const KeyOf& key_of) const {
    return buckets_[bucket(key, key_of)] - 1;
  }
  // key_of(place) is `key` already.
  template <typename KeyOf>
  void enter(std::uint64_t key, std::int32_t place, const KeyOf& key_of) {
    std::int32_t& b = buckets_[bucket(key, key_of)];
    assert(b == 0);
    b = place + 1;
  }
  // Those behind the hole move up, so that they are still found. key_of(its place) is still `key`.
  template <typename KeyOf>
  void forget(std::uint64_t key, const KeyOf& key_of) {
    std::size_t hole = bucket(key, key_of);
    assert(buckets_[hole] != 0);
    for (std::size_t b = next(hole); buckets_[b] != 0; b = next(b)) {
      const std::size_t home = home_of(key_of(buckets_[b] - 1));
      const bool reachable = ((b - home) & mask()) < ((b - hole) & mask());
      if (reachable) continue;
      buckets_[hole] = buckets_[b];
      hole = b;
    }
    buckets_[hole] = 0;
  }

 private:
  std::size_t mask() const { return buckets_.size() - 1; }
  std::size_t next(std::size_t b) const { return (b + 1) & mask(); }
  std::size_t home_of(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15U) >> 32u) & mask();
  }
  template <typename KeyOf>
  std::size_t bucket(std::uint64_t key, const KeyOf& key_of) const {
    std::size_t b = home_of(key);
    while (buckets_[b] != 0 && key_of(buckets_[b] - 1) != key) b = next(b);
    return b;
  }

  std::span<std::int32_t> buckets_;  // place + 1; 0: free
};

}  // namespace zenith::exchange
