#pragma once
// Memory for anything that is laid out in an Arena, as the daemon and the tools give it: counted
// first, then taken from one aligned block that lives as long as this.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "platform/base/arena.h"

namespace zenith {

class ArenaBlock {
 public:
  // `layout` is called twice with an Arena&.
  template <typename Layout>
  explicit ArenaBlock(const Layout& layout) {
    Arena count;
    layout(count);
    memory_.resize(count.used() + Arena::kAlignment);
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.data());
    const std::size_t skip = (Arena::kAlignment - address % Arena::kAlignment) % Arena::kAlignment;
    Arena arena(std::span<std::byte>(memory_).subspan(skip, count.used()));
    layout(arena);
  }
  ArenaBlock(const ArenaBlock&) = delete;
  ArenaBlock& operator=(const ArenaBlock&) = delete;

 private:
  std::vector<std::byte> memory_;
};

}  // namespace zenith
