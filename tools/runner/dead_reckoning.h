#pragma once
// The pose by the wheels alone, from the first frame: what SLAM is measured against.

#include <optional>
#include <span>

#include "slam/filter/motion.h"

namespace zenith::tools {

class DeadReckoning {
 public:
  // The pose at `stamp`, in the frame of the first call. Stamps rise.
  Pose2 advance(const Wheels& wheels, Time stamp, std::span<const WheelSample> samples) {
    for (const WheelSample& sample : samples) history_.add(sample);
    const WheelHistory::At now = history_.at(stamp);
    if (!now.known) return pose_;
    if (last_) {
      const WheelTravel moved{now.total.left_m - last_->left_m, now.total.right_m - last_->right_m};
      pose_ = pose_ * wheel_motion(wheels, moved);
    }
    last_ = now.total;
    return pose_;
  }

 private:
  WheelHistory history_;
  std::optional<WheelTravel> last_;
  Pose2 pose_;
};

}  // namespace zenith::tools
