#pragma once
// A recording of a second, for tests: 10 frames of 32 x 24 pixels, wheels at 50 Hz.

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/odometry/agilex_v2.h"
#include "platform/recording/writer.h"

namespace zenith::tools {

inline RobotConfig small_robot() {
  RobotConfig config;
  config.lens = {32, 24, 9.5, 9.25, 16.125, 12.0625, {0.01, -0.002, 0.0003, -0.00004}};
  config.mount = {0.06, -0.02, 0.31, 0.02, -0.03, 0.5};
  config.wheels = {0.437, 1.01, 0.993};
  config.frame_rate_hz = 10.0;
  return config;
}

inline Time small_stamp(int frame) {
  return {1'000'000'007 + frame * 100'000'000LL};
}

inline std::vector<std::uint8_t> small_pixels(int frame) {
  std::vector<std::uint8_t> pixels(32 * 24);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(31 * i + 7 * static_cast<std::size_t>(frame));
  }
  return pixels;
}

inline Pose2 small_pose(int frame) {
  return {0.1 * frame, -0.05 * frame, 0.3 * frame};
}

inline void write_small_recording(const std::filesystem::path& folder) {
  const RobotFile robot;
  auto writer = RecordingWriter::create(folder, small_robot(), robot);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i <= 60; ++i) {
    const Time stamp{1'000'000'000 + i * 20'000'000LL};
    writer->add_can(agilex_v2::encode_odometer(stamp, {10 * i, 11 * i}));
  }
  for (int i = 0; i < 10; ++i) {
    const auto pixels = small_pixels(i);
    ASSERT_TRUE(writer->add_frame(small_stamp(i), {pixels.data(), 32, 24, 32}).ok());
    writer->add_truth(small_stamp(i), small_pose(i));
  }
  ASSERT_TRUE(writer->finish().ok());
}

}  // namespace zenith::tools
