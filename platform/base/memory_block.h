#pragma once
// The one block of memory that a Slam is built in.

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "platform/base/arena.h"

namespace zenith {

class MemoryBlock {
 public:
  // Allocates, as new does: to be made at start.
  explicit MemoryBlock(std::size_t bytes)
      : bytes_(bytes), memory_(static_cast<std::byte*>(::operator new(bytes, kAlignment))) {}
  std::span<std::byte> span() const { return {memory_.get(), bytes_}; }

 private:
  static constexpr std::align_val_t kAlignment{Arena::kAlignment};
  struct Free {
    void operator()(std::byte* block) const { ::operator delete(block, kAlignment); }
  };
  std::size_t bytes_;
  std::unique_ptr<std::byte, Free> memory_;
};

}  // namespace zenith
