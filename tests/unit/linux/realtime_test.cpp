#include "platform/linux/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/thread.h"
#include "tests/unit/linux/without_rights.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ZENITH_TEST_SANITIZED 1  // their runtime turns mlockall() into nothing
#else
#define ZENITH_TEST_SANITIZED 0
#endif

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Realtime, MemoryIsLockedOrTheReportSaysWhatToDo) {
  Report report;
  const bool locked = lock_memory(report);
  munlockall();
  if (locked) {
    EXPECT_TRUE(report.empty());
  } else {
    EXPECT_THAT(report, ElementsAre(HasSubstr("LimitMEMLOCK=")));
  }
}

// Exits with 0 when the refusal was told in one line.
void try_to_lock_without_rights() {
  Report report;
  if (!give_up_rights()) std::exit(2);
  const bool locked = lock_memory(report);
  std::fprintf(stderr, "%s\n", report.empty() ? "no report" : report[0].c_str());
  std::exit(!locked && report.size() == 1 ? 0 : 1);
}

TEST(RealtimeDeathTest, ARefusalToLockIsTold) {
  if (ZENITH_TEST_SANITIZED) GTEST_SKIP() << "sanitizers turn mlockall() into nothing";
  EXPECT_EXIT(try_to_lock_without_rights(), ::testing::ExitedWithCode(0),
              "limit 0 KiB; set LimitMEMLOCK=");
}

TEST(Realtime, LatencyHolderWritesZeroAndHoldsTheFile) {
  char path[] = "/tmp/zenith_latency_XXXXXX";
  const int fd = mkstemp(path);
  ASSERT_GE(fd, 0);
  Report report;
  CpuDmaLatency latency;
  EXPECT_TRUE(latency.hold(report, path));
  EXPECT_TRUE(latency.held());
  EXPECT_TRUE(report.empty());
  std::int32_t value = -1;
  EXPECT_EQ(read(fd, &value, sizeof(value)), 4);
  EXPECT_EQ(value, 0);
  close(fd);
  unlink(path);
}

TEST(Realtime, LatencyHolderReportsAMissingDevice) {
  Report report;
  CpuDmaLatency latency;
  EXPECT_FALSE(latency.hold(report, "/nonexistent/latency"));
  EXPECT_FALSE(latency.held());
  EXPECT_THAT(report, ElementsAre(AllOf(HasSubstr("/nonexistent/latency"), HasSubstr("ENOENT"),
                                        HasSubstr("udev"))));
}

// Exits with 0 when a large block that was freed is there again without a page fault.
void use_a_block_twice() {
  constexpr std::size_t kBytes = std::size_t{8} << 20U;
  const auto use = [] {
    auto* block = static_cast<volatile char*>(std::malloc(kBytes));
    for (std::size_t i = 0; i < kBytes; i += 4096) block[i] = 1;
    std::free(const_cast<char*>(block));
  };
  pin_heap();
  use();
  const std::uint64_t before = thread_page_faults().minor;
  use();
  std::fprintf(stderr, "%llu faults\n",
               static_cast<unsigned long long>(thread_page_faults().minor - before));
  std::exit(thread_page_faults().minor - before < 16 ? 0 : 1);
}

TEST(RealtimeDeathTest, WhatIsFreedStaysInThePinnedHeap) {
  if (ZENITH_TEST_SANITIZED) GTEST_SKIP() << "a sanitizer has the heap";
  EXPECT_EXIT(use_a_block_twice(), ::testing::ExitedWithCode(0), "");
}

// Exits with 0 when the thread lost its priority, and 77 where there is none to lose.
void run_away() {
  Report report;
  if (!limit_realtime(Duration{200'000'000}, report)) std::exit(2);
  rlimit time = {};
  getrlimit(RLIMIT_RTTIME, &time);
  if (time.rlim_cur != 200'000 || time.rlim_max != 400'000) std::exit(3);
  Thread thread;
  int policy = -1;
  const auto body = [&] {
    while (!realtime_overrun()) {
    }
    policy = sched_getscheduler(0);
  };
  const ThreadOptions options = {.name = "runaway", .fifo_priority = 1};
  const int granted = sched_get_priority_min(SCHED_FIFO);
  const sched_param wanted = {.sched_priority = granted};
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) std::exit(77);
  const sched_param none = {};
  sched_setscheduler(0, SCHED_OTHER, &none);
  if (!thread.start(options, body, report)) std::exit(4);
  thread.join();
  std::exit(policy == SCHED_OTHER ? 0 : 1);
}

TEST(RealtimeDeathTest, AThreadThatNeverWaitsLosesItsPriority) {
  const auto ended = [](int status) {
    return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 77);
  };
  EXPECT_EXIT(run_away(), ended, "");
}

TEST(Realtime, TouchedPagesCountAsFaults) {
  constexpr std::size_t kPages = 64;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* memory =
      mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  madvise(memory, kPages * page, MADV_NOHUGEPAGE);
  const PageFaults before = thread_page_faults();
  for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(memory)[i * page] = 1;
  const PageFaults after = thread_page_faults();
  munmap(memory, kPages * page);
  EXPECT_GE(after.minor - before.minor, kPages);
}

TEST(Realtime, LimitsAreThoseOfTheKernel) {
  rlimit limit = {};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  EXPECT_EQ(realtime_limits().locked_bytes,
            limit.rlim_cur == RLIM_INFINITY ? RealtimeLimits::kUnlimited : limit.rlim_cur);
  getrlimit(RLIMIT_RTPRIO, &limit);
  EXPECT_EQ(realtime_limits().fifo_priority,
            limit.rlim_cur == RLIM_INFINITY ? RealtimeLimits::kUnlimited : limit.rlim_cur);
}

}  // namespace
}  // namespace zenith
