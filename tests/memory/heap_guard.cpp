// Stands in for the C library's heap in this test program: the same heap, watched.

#include "tests/memory/heap_guard.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ZENITH_HEAP_IS_TAKEN 1
#else
#define ZENITH_HEAP_IS_TAKEN 0
#endif

namespace {

// No constructor and no lazy storage: it is touched inside of malloc.
__thread bool t_guarded = false;
__thread std::uint64_t t_calls = 0;
__thread const char* t_forbidden_in = nullptr;
std::atomic<int> g_new_fails_in = 0;

}  // namespace

namespace zenith {

HeapGuard::HeapGuard() {
  t_calls = 0;
  t_guarded = true;
}
HeapGuard::~HeapGuard() {
  t_guarded = false;
}
std::uint64_t HeapGuard::calls() const {
  return t_calls;
}
bool HeapGuard::works() {
  return ZENITH_HEAP_IS_TAKEN == 0;
}

void fail_next_new(int thread) {
  g_new_fails_in.store(thread);
}

NoAllocation::NoAllocation(const char* in) {
  t_forbidden_in = in;
}
NoAllocation::~NoAllocation() {
  t_forbidden_in = nullptr;
}

}  // namespace zenith

#if !ZENITH_HEAP_IS_TAKEN

namespace {

void say(const char* text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
}

void use(const char* call) {
  if (t_guarded) ++t_calls;
  if (t_forbidden_in == nullptr) return;
  const char* in = t_forbidden_in;
  t_forbidden_in = nullptr;  // what abort() does is its own business
  for (const char* text : {call, "() called in ", in, ", which must not use the heap\n"}) say(text);
  std::abort();
}

}  // namespace

void* operator new(std::size_t bytes) {
  int fails_in = g_new_fails_in.load(std::memory_order_relaxed);
  if (fails_in != 0 && fails_in == static_cast<int>(::syscall(SYS_gettid)) &&
      g_new_fails_in.compare_exchange_strong(fails_in, 0)) {
    throw std::bad_alloc();
  }
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*bytes*/) noexcept {
  std::free(memory);
}

// glibc's own names of what is replaced.
extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t bytes) {
  use("malloc");
  return __libc_malloc(bytes);
}
void free(void* memory) {
  use("free");
  __libc_free(memory);
}
void* calloc(std::size_t items, std::size_t bytes) {
  use("calloc");
  return __libc_calloc(items, bytes);
}
void* realloc(void* memory, std::size_t bytes) {
  use("realloc");
  return __libc_realloc(memory, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  use("memalign");
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  use("aligned_alloc");
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
  use("posix_memalign");
  *memory = __libc_memalign(alignment, bytes);
  return *memory != nullptr ? 0 : ENOMEM;
}
}

#endif
