#pragma once
// Watches over the calling thread's use of the heap: malloc, free and all of their family, so new
// and delete too. For programs that heap_guard.cpp is linked into. One guard a thread at a time.

#include <cstdint>

namespace zenith {

// How often the thread used the heap since the guard was made.

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

// The next `new` of this thread (gettid()) throws std::bad_alloc, once. Not with sanitizers.
void fail_next_new(int thread);

// As long as it lives, any use of the heap by the thread that made it ends the program, and says
// which call it was and in what.
class NoAllocation {
 public:
  explicit NoAllocation(const char* in);  // a literal, such as "Slam::step"
  ~NoAllocation();
  NoAllocation(const NoAllocation&) = delete;
  NoAllocation& operator=(const NoAllocation&) = delete;
};

}  // namespace zenith
