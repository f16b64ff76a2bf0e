#include <array>
#include <vector>

#include "platform/daemon/perception.h"

namespace zenith {
namespace {

// Blocks of random grey: corners everywhere.
std::vector<std::uint8_t> blocks(const Lens& lens, int shift_px) {
  constexpr int kBlock_px = 24;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(lens.width_px) * lens.height_px);
  for (int v = 0; v < lens.height_px; ++v) {
    for (int u = 0; u < lens.width_px; ++u) {
      const int block = (u + shift_px) / kBlock_px * 31 + v / kBlock_px * 17;
      pixels[static_cast<std::size_t>(v) * lens.width_px + u] =
          static_cast<std::uint8_t>(block * 2654435761U >> 13);
    }
  }
  return pixels;
}

}  // namespace

void warm_up(const RobotConfig& robot, const Parameters& parameters) {
  constexpr int kFrames = 12;
  constexpr double kStep_m = 0.05;
  Parameters few = parameters;
  few.particles = 16;
  const MemoryBlock memory(Slam::memory_needed(few));
  Slam slam(robot, few, 1, memory.span());
  std::array<LandmarkRecord, 16> records;
  for (int i = 0; i < kFrames; ++i) {
    const Time stamp = {std::int64_t{i + 1} * 100'000'000};
    const WheelSample sample = {stamp, kStep_m * i, kStep_m * i};
    const auto pixels = blocks(robot.lens, 2 * i);
    const ImageView frame = {pixels.data(), robot.lens.width_px, robot.lens.height_px,
                             robot.lens.width_px};
    slam.step({stamp, frame, {&sample, 1}, kMaxCorners});
    const std::size_t count = slam.publish(records);
    slam.receive(0, std::span(records).first(count));
  }
}

}  // namespace zenith
