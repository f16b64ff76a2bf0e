#pragma once
// What the camera saw of the robot's motion over a recording, without wheels: intervals between
// frames that have moved enough against each other, as slam/watch takes them (visual_motion.h).

#include <span>
#include <vector>

#include "slam/watch/visual_motion.h"

namespace zenith::tools {

struct SeenInterval {
  double from_s = 0.0;
  double to_s = 0.0;
  VisualMotion seen;  // known
};

class SeenMotion {
 public:
  // Frames in the order of their stamps, their features strongest first.
  void add(double time_s, std::span<const Feature> features);

  const std::vector<SeenInterval>& intervals() const { return intervals_; }

 private:
  KeptCorners reference_;
  double reference_s_ = 0.0;
  bool has_reference_ = false;
  std::vector<SeenInterval> intervals_;
};

}  // namespace zenith::tools
