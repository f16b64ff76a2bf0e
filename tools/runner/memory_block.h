#pragma once
// The one block of memory that a Slam is built in.

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>

#include "platform/base/arena.h"

namespace zenith::tools {

class MemoryBlock {
 public:
  explicit MemoryBlock(std::size_t bytes) : bytes_(bytes) {
    constexpr std::size_t kAlignment = Arena::kAlignment;
    const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    memory_.reset(static_cast<std::byte*>(std::aligned_alloc(kAlignment, rounded)));
    if (memory_ == nullptr) throw std::bad_alloc();
  }
  std::span<std::byte> span() const { return {memory_.get(), bytes_}; }

 private:
  struct Free {
    void operator()(std::byte* block) const { std::free(block); }
  };
  std::size_t bytes_;
  std::unique_ptr<std::byte, Free> memory_;
};

}  // namespace zenith::tools
