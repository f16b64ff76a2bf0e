#include "tools/report/pose_jumps.h"

#include <algorithm>
#include <cmath>

namespace zenith::tools {
namespace {

// How far the estimate's motion from frame `i` to frame `k` is off.
Pose2 off(std::span<const FrameLog> frames, std::size_t i, std::size_t k) {
  const Pose2 truth = frames[i].truth->inverse() * *frames[k].truth;
  return truth.inverse() * (frames[i].T_start_robot.inverse() * frames[k].T_start_robot);
}

double turn(const Pose2& pose) {
  return std::abs(pose.theta_rad);
}

bool is_wrong(std::span<const FrameLog> frames, const PoseJump& jump) {
  const std::size_t before = jump.frame - 1;
  const bool moved = jump.position_m > kJump_m;
  const bool turned = jump.angle_rad > kJump_rad;
  const Pose2 error_before = off(frames, 0, before);
  const Pose2 error_after = off(frames, 0, jump.frame);
  if (moved && error_after.position().norm() > error_before.position().norm()) return true;
  if (turned && turn(error_after) > turn(error_before)) return true;
  const std::size_t end = std::min(jump.frame + kUndoneFrames + 1, frames.size());
  for (std::size_t k = jump.frame + 1; k < end; ++k) {
    const Pose2 left = off(frames, before, k);
    if (moved && left.position().norm() < 0.5 * jump.position_m) return true;
    if (turned && turn(left) < 0.5 * jump.angle_rad) return true;
  }
  return false;
}

}  // namespace

std::vector<PoseJump> find_jumps(std::span<const FrameLog> frames) {
  std::vector<PoseJump> jumps;
  for (const FrameLog& frame : frames) {
    if (!frame.truth) return {};
  }
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Pose2 step = off(frames, i - 1, i);
    PoseJump jump = {i, step.position().norm(), turn(step), false};
    if (jump.position_m <= kJump_m && jump.angle_rad <= kJump_rad) continue;
    jump.wrong = is_wrong(frames, jump);
    jumps.push_back(jump);
  }
  return jumps;
}

}  // namespace zenith::tools
