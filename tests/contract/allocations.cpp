#include "tests/contract/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::uint64_t> g_count = 0;
thread_local std::uint64_t t_count = 0;

}  // namespace

namespace zenith {

std::uint64_t allocation_count() {
  return g_count.load();
}

std::uint64_t thread_allocation_count() {
  return t_count;
}

}  // namespace zenith

// The others that are used (arrays, nothrow) call these.
void* operator new(std::size_t bytes) {
  ++g_count;
  ++t_count;
  if (void* memory = std::malloc(bytes != 0 ? bytes : 1)) return memory;
  std::abort();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
