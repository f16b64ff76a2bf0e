// The guard itself: every call that uses the heap ends the program inside of NoAllocation, and only
// there.

#include "tests/memory/heap_guard.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "tests/memory/eigen_no_malloc.h"

namespace zenith {
namespace {

// What the compiler must not leave out.
template <typename T>
void keep(T* memory) {
  asm volatile("" : : "r"(memory) : "memory");
}

struct ForbiddenCall {
  const char* name;     // of the call
  const char* dies_of;  // what the message names: new and delete use the C library's heap
  std::function<void(void*)> use;  // of memory that came from malloc
};

struct alignas(128) Wide {
  char bytes[128];
};

const ForbiddenCall kCalls[] = {
    {"malloc", "malloc", [](void*) { keep(std::malloc(16)); }},
    {"calloc", "calloc", [](void*) { keep(std::calloc(2, 16)); }},
    {"realloc", "realloc", [](void* memory) { keep(std::realloc(memory, 100000)); }},
    {"free", "free", [](void* memory) { std::free(memory); }},
    {"freeOfNothing", "free",
     [](void*) {
       void* nothing = nullptr;
       asm volatile("" : "+r"(nothing));
       std::free(nothing);
     }},
    {"aligned_alloc", "aligned_alloc", [](void*) { keep(std::aligned_alloc(64, 64)); }},
    {"posix_memalign", "posix_memalign",
     [](void*) {
       void* memory = nullptr;
       if (::posix_memalign(&memory, 64, 64) == 0) keep(memory);
     }},
    {"memalign", "memalign", [](void*) { keep(::memalign(64, 64)); }},
    {"new", "malloc", [](void*) { keep(new int(3)); }},
    {"newOfAnArray", "malloc", [](void*) { keep(new int[30]); }},
    {"newThatMayFail", "malloc", [](void*) { keep(new (std::nothrow) int(3)); }},
    {"newAligned", "aligned_alloc", [](void*) { keep(new Wide); }},
    {"delete", "free", [](void* memory) { ::operator delete(memory); }},
    {"vector", "malloc", [](void*) { keep(std::vector<int>(10).data()); }},
    {"string", "malloc", [](void*) { keep(std::string(100, 'x').data()); }},
};

class NoAllocationDeathTest : public testing::TestWithParam<ForbiddenCall> {};

TEST_P(NoAllocationDeathTest, EndsTheProgramAt) {
  if (!HeapGuard::works()) GTEST_SKIP() << "a sanitizer has the heap";
  void* memory = std::malloc(16);
  EXPECT_DEATH(
      {
        const NoAllocation guard("a step");
        GetParam().use(memory);
      },
      std::string("^") + GetParam().dies_of +
          "\\(\\) called in a step, which must not use the heap");
  std::free(memory);
}

INSTANTIATE_TEST_SUITE_P(Calls, NoAllocationDeathTest, testing::ValuesIn(kCalls),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(NoAllocation, LeavesOthersAlone) {
  { const NoAllocation guard("a step"); }
  keep(std::make_unique<int>(3).get());  // afterwards
  std::atomic<bool> guarded = false;
  std::atomic<bool> used = false;
  std::thread other([&] {
    while (!guarded) std::this_thread::yield();
    keep(std::make_unique<int>(4).get());  // another thread
    used = true;
  });
  {
    const NoAllocation guard("a step");
    guarded = true;
    while (!used) std::this_thread::yield();
  }
  other.join();
}

// Eigen's own check is compiled into what this program tests, and works.
TEST(EigenNoMallocDeathTest, EndsTheProgramAtADynamicMatrix) {
  EXPECT_DEATH(
      {
        const EigenNoMalloc forbidden;
        Eigen::MatrixXd matrix(9, 9);
        keep(matrix.data());
      },
      "heap allocation is forbidden");
  Eigen::MatrixXd matrix(9, 9);  // afterwards
  keep(matrix.data());
  const EigenNoMalloc forbidden;
  Eigen::Matrix<double, 9, 9> fixed = Eigen::Matrix<double, 9, 9>::Zero();
  keep(fixed.data());
}

}  // namespace
}  // namespace zenith
