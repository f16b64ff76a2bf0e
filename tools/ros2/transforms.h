#pragma once
// ROS 2's transforms between frames: /tf, and /tf_static for those who come later, too.

#include <cstdint>
#include <string>
#include <vector>

#include "tools/ros2/motion.h"
#include "tools/ros2/participant.h"

namespace zenith::ros2 {

struct FrameTransform {
  std::int64_t system_ns = 0;
  std::string parent;
  std::string child;
  Pose2 T_parent_child;
};

class Transforms {
 public:
  static Result<Transforms> make(const Participant& participant);

  Status send(const std::vector<FrameTransform>& moving) const;
  // All that are fixed, each time: later ones replace earlier ones of the same child. ROS 2 has no
  // way to take one back.
  Status send_static(const std::vector<FrameTransform>& fixed) const;

 private:
  Writer moving_;
  Writer fixed_;
};

}  // namespace zenith::ros2
