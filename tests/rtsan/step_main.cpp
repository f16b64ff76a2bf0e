// The step as clang's realtime sanitizer sees it: a function that must not block. Whatever it
// reaches and is not for realtime code - the heap, locks, files, sleep - ends the program with a
// report (./dev rtsan).
//
//   rtsan_step           drives through a made-up hall, searching a peer's map
//   rtsan_step CALL      does one forbidden thing in the same place: the sanitizer must see it

#include <time.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <vector>

#include "platform/base/memory_block.h"
#include "slam/slam.h"
#include "tests/support/hall.h"

namespace zenith {
namespace {

constexpr int kFrames = 240;
constexpr double kStep_m = 0.05;

// The entry. All that it calls is checked.
void step(Slam& slam, const StepInput& input, std::span<LandmarkRecord> records,
          std::size_t& told) noexcept [[clang::nonblocking]] {
  slam.step(input);
  told = slam.publish(records);
  slam.receive(0, records.first(told));
}

void forbidden(std::string_view call, std::mutex& mutex) noexcept [[clang::nonblocking]] {
  if (call == "malloc") {
    void* memory = std::malloc(16);
    asm volatile("" : : "r"(memory) : "memory");
    std::free(memory);
  } else if (call == "lock") {
    const std::lock_guard lock(mutex);
  } else if (call == "file") {
    if (std::FILE* file = std::fopen("/dev/null", "r")) std::fclose(file);
  } else if (call == "sleep") {
    const timespec moment = {0, 1000};
    ::nanosleep(&moment, nullptr);
  }
}

int drive() {
  const RobotConfig robot;
  const MemoryBlock memory(Slam::memory_needed({}));
  Slam slam(robot, {}, 1, memory.span());
  Hall hall(robot.lens);
  std::vector<LandmarkRecord> records(256);
  std::size_t told = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Time stamp = {std::int64_t{i + 1} * 100'000'000};
    const WheelSample sample = {stamp, kStep_m * i, kStep_m * i};
    std::size_t now = 0;
    step(slam, {stamp, hall.seen_from({kStep_m * i, 0.0, 0.0}), {&sample, 1}, kMaxCorners}, records,
         now);
    told += now;
  }
  const bool searched = !slam.alignments().empty();
  std::printf("%d steps, %zu records told, %.2f m driven, a peer's map %s\n", kFrames, told,
              slam.output().T_start_robot.x_m, searched ? "searched" : "NOT searched");
  return told > 100 && searched ? 0 : 1;
}

}  // namespace
}  // namespace zenith

int main(int argc, char** argv) {
  if (argc == 1) return zenith::drive();
  std::mutex mutex;
  zenith::forbidden(argv[1], mutex);
  std::printf("%s was not seen\n", argv[1]);
  return 0;
}
