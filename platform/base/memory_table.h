#pragma once
// What fixed memory is for: named parts and their bytes, in the order in which they were first
// named. Filled by an Arena that counts, so that it says what the layout does.

#include <cassert>
#include <cstddef>
#include <span>
#include <string_view>

#include "platform/base/fixed_vector.h"

namespace zenith {

struct MemoryPart {
  const char* name = "";  // a literal
  std::size_t bytes = 0;
};

class MemoryTable {
 public:
  void add(const char* name, std::size_t bytes) {
    for (MemoryPart& part : parts_) {
      if (std::string_view(part.name) != name) continue;
      part.bytes += bytes;
      return;
    }
    const bool taken = parts_.push_back({name, bytes});
    assert(taken);
    if (!taken) parts_[parts_.size() - 1].bytes += bytes;  // the total stays right
  }
  void add(const MemoryTable& other) {
    for (const MemoryPart& part : other.parts()) add(part.name, part.bytes);
  }

  std::span<const MemoryPart> parts() const { return parts_.span(); }
  std::size_t total() const {
    std::size_t sum = 0;
    for (const MemoryPart& part : parts_) sum += part.bytes;
    return sum;
  }

 private:
  FixedVector<MemoryPart, 24> parts_;
};

}  // namespace zenith
