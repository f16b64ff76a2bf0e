// The step as clang's realtime sanitizer sees it: a function that must not block. Whatever it
// reaches and is not for realtime code - the heap, locks, files, sleep - ends the program with a
// report (./dev rtsan).
//
//   rtsan_step           drives through a made-up hall, searching a peer's map
//   rtsan_step CALL      does one forbidden thing in the same place: the sanitizer must see it

#include <time.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <vector>

#include "platform/base/memory_block.h"
#include "slam/slam.h"

namespace zenith {
namespace {

constexpr int kFrames = 240;
constexpr double kStep_m = 0.05;
constexpr double kCeiling_m = 2.4;  // above the camera
constexpr double kTile_m = 0.23;

// Tiles of random grey, as a camera below sees them. Rays are made once.
class Hall {
 public:
  explicit Hall(const Lens& lens) : lens_(lens), pixels_(rays()) {}

  ImageView seen_from(double x_m) {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const auto column = static_cast<long>(std::floor((rays_[i].x() + x_m) / kTile_m));
      const auto row = static_cast<long>(std::floor(rays_[i].y() / kTile_m));
      const auto tile = static_cast<std::uint64_t>(column * 73856093L ^ row * 19349663L);
      pixels_[i] = static_cast<std::uint8_t>((tile * 0x9E3779B97F4A7C15U) >> 56U);
    }
    return {pixels_.data(), lens_.width_px, lens_.height_px, lens_.width_px};
  }

 private:
  std::size_t rays() {
    for (int v = 0; v < lens_.height_px; ++v) {
      for (int u = 0; u < lens_.width_px; ++u) {
        const Eigen::Vector3d ray = lens_.unproject({u, v});
        rays_.push_back(ray.head<2>() * kCeiling_m / std::max(ray.z(), 0.05));
      }
    }
    return rays_.size();
  }

  Lens lens_;
  std::vector<Eigen::Vector2d> rays_;  // where they meet the ceiling
  std::vector<std::uint8_t> pixels_;
};

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
    step(slam, {stamp, hall.seen_from(kStep_m * i), {&sample, 1}, kMaxCorners}, records, now);
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
