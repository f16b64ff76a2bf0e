#pragma once
// Jumps of the online pose: frames whose increment is off by more than 5 cm or 1 degree.
//
//   off(i, k) = (truth_i^-1 truth_k)^-1 (pose_i^-1 pose_k),   a jump: off(i - 1, i)
//
// A closing may make one. It is wrong when the error in the start frame, where estimate and truth
// agree at the first frame, is larger after it than before, or when it is undone: within the next
// 20 frames off(i - 1, k) falls below half of it. Positions and headings are judged each by itself.

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "tools/runner/run_log.h"

namespace zenith::tools {

inline constexpr double kJump_m = 0.05;
inline constexpr double kJump_rad = std::numbers::pi / 180.0;
inline constexpr std::size_t kUndoneFrames = 20;

struct PoseJump {
  std::size_t frame = 0;
  double position_m = 0.0;
  double angle_rad = 0.0;
  bool wrong = false;
};

// In the order of the frames, all of which have ground truth; empty when one has none.
std::vector<PoseJump> find_jumps(std::span<const FrameLog> frames);

}  // namespace zenith::tools
