#pragma once
// Fixed memory: one block, handed out once at start, never given back.
//
// The same layout code runs twice: over an Arena without a block it only counts the bytes
// (memory_needed), over a real block it hands out aligned, value-initialised arrays. Running out is
// a programmer's mistake, for the block's size came from the first run; it ends the program before
// anything is written beyond the block, in every build.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "platform/base/ensure.h"
#include "platform/base/memory_table.h"

namespace zenith {

class Arena {
 public:
  static constexpr std::size_t kAlignment = 64;  // a cache line, an AVX-512 register

  Arena() = default;  // counts only
  // Counts, and tells `table` what for.
  explicit Arena(MemoryTable& table) : table_(&table) {}
  explicit Arena(std::span<std::byte> block) : block_(block) {
    ensure(reinterpret_cast<std::uintptr_t>(block.data()) % kAlignment == 0,
           "Arena: the block is not aligned to 64 bytes");
  }

  // What the memory is for that is taken from now on: a literal.
  void part(const char* name) { part_ = name; }

  bool counting() const { return block_.data() == nullptr; }
  std::size_t used() const { return used_; }

  // `count` value-initialised Ts; an empty span while counting.
  template <typename T>
  std::span<T> take(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "nobody will destroy it");
    static_assert(alignof(T) <= kAlignment);
    const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    const std::size_t offset = used_;
    used_ += bytes;
    if (table_ != nullptr) table_->add(part_, bytes);
    if (counting()) return {};
    ensure(used_ <= block_.size(), "Arena: the block is too small");
    T* start = reinterpret_cast<T*>(block_.data() + offset);
    std::uninitialized_value_construct_n(start, count);
    return {start, count};
  }

 private:
  std::span<std::byte> block_;
  std::size_t used_ = 0;
  MemoryTable* table_ = nullptr;
  const char* part_ = "other";
};

}  // namespace zenith
