// With memory locked, the step touches no page that is not there.

#include <sys/mman.h>

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/memory_block.h"
#include "platform/linux/realtime.h"
#include "slam/slam.h"
#include "tests/memory/heap_guard.h"
#include "tests/support/figure.h"
#include "tools/runner/simulated_source.h"

namespace zenith {
namespace {

// As much as the daemon's threads touch of theirs.
constexpr std::size_t kStackTouched = std::size_t{256} * 1024;
constexpr int kWarmUp = 20;

std::uint64_t faults_so_far() {
  const PageFaults faults = thread_page_faults();
  return faults.minor + faults.major;
}

std::uint64_t faults_in(auto&& work) {
  const std::uint64_t before = faults_so_far();
  work();
  return faults_so_far() - before;
}

TEST(PageFaults, AreCounted) {
  constexpr std::size_t kPages = 16;
  const std::size_t page = 4096;
  void* fresh =
      ::mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(fresh, MAP_FAILED);
  ASSERT_EQ(::madvise(fresh, kPages * page, MADV_NOHUGEPAGE), 0);
  auto* bytes = static_cast<volatile char*>(fresh);
  const auto touch = [&] {
    for (std::size_t i = 0; i < kPages; ++i) bytes[i * page] = 1;
  };
  EXPECT_GE(faults_in(touch), kPages);
  EXPECT_EQ(faults_in(touch), 0U) << "they are there now";
  ::munmap(fresh, kPages * page);
}

TEST(PageFaults, NoneInAStepOnceMemoryIsLocked) {
  if (!HeapGuard::works()) GTEST_SKIP() << "with a sanitizer memory cannot be locked";
  const auto team = tools::simulate_team("corridor-rooms", 1, 14.0, Parameters{});
  ASSERT_TRUE(team.ok());
  Source& source = *team->sources[0];
  const MemoryBlock memory(Slam::memory_needed({}));
  Slam slam(source.config(), {}, 1, memory.span());
  std::vector<LandmarkRecord> records(64);
  SourceFrame frame;

  Report report;
  if (!lock_memory(report)) {
    GTEST_SKIP() << "NOT TESTED, memory may not be locked here: " << report.back();
  }
  prefault_stack(kStackTouched);
  const Lens& lens = source.config().lens;
  int steps = 0;
  std::uint64_t faults = 0;
  for (;;) {
    const auto more = source.next(frame);
    if (!more.ok() || !*more) break;
    const StepInput input = {frame.stamp,
                             {frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px},
                             frame.wheels};
    const std::uint64_t here = faults_in([&] {
      slam.step(input);
      // A peer that has the same map: its search and its alignment are under test.
      const std::size_t count = slam.publish(records);
      slam.receive(0, std::span(records).first(count));
    });
    if (++steps <= kWarmUp) continue;
    faults += here;
    EXPECT_EQ(here, 0U) << "in step " << steps;
  }
  ::munlockall();
  EXPECT_GT(steps, kWarmUp + 100);
  EXPECT_FALSE(slam.alignments().empty()) << "no peer's map was searched";
  print_figure("memory: %llu page faults in %d steps with locked memory",
               static_cast<unsigned long long>(faults), steps - kWarmUp);
}

}  // namespace
}  // namespace zenith
