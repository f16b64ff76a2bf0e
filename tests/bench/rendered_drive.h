#pragma once
// Frames of a simulated robot in memory, rendered once for all benchmarks.

#include <cstdint>
#include <vector>

#include "slam/features.h"
#include "slam/image/image.h"
#include "slam/robot.h"
#include "slam/wheels.h"
#include "tests/support/arena_block.h"

namespace zenith::bench {

struct RenderedFrame {
  Time stamp;
  std::vector<std::uint8_t> pixels;
  std::vector<WheelSample> wheels;
};

struct RenderedDrive {
  RobotConfig robot;
  std::vector<RenderedFrame> frames;

  ImageView image(std::size_t i) const {
    const Lens& lens = robot.lens;
    return {frames[i].pixels.data(), lens.width_px, lens.height_px, lens.width_px};
  }
};

// Robot r1 of corridor-rooms, its first 30 s: about 10 m through an office, with turns.
const RenderedDrive& corridor_rooms();

// A FeatureExtractor for the drive's robot.
class ExtractorRig {
 public:
  explicit ExtractorRig(const RobotConfig& robot)
      : block_([this](Arena& arena) { extractor_.layout(arena); }) {
    extractor_.build(robot, Parameters{});
  }
  FeatureExtractor& operator*() { return extractor_; }
  FeatureExtractor* operator->() { return &extractor_; }

 private:
  FeatureExtractor extractor_;
  ArenaBlock block_;
};

}  // namespace zenith::bench
