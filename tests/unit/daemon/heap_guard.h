#pragma once
// How often the calling thread used the heap (malloc, free and all of their family, so new and
// delete too) since the guard was made. One guard a thread at a time.

#include <cstdint>

namespace zenith {

class HeapGuard {
 public:
  HeapGuard();
  ~HeapGuard();
  HeapGuard(const HeapGuard&) = delete;
  HeapGuard& operator=(const HeapGuard&) = delete;

  std::uint64_t calls() const;
  // False with sanitizers, which have the heap for themselves.
  static bool works();
};

}  // namespace zenith
