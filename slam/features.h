#pragma once
// From a fisheye frame to described corners: the image stage of the step.
//
// The corners' threshold follows the light: with too few corners it sinks from frame to frame, with
// enough it returns to the configured value. In dim light contrast falls with the exposure, and
// eigenvalues with its square.

#include <array>

#include "platform/base/arena.h"
#include "platform/base/fixed_vector.h"
#include "slam/image/corners.h"
#include "slam/image/feature.h"
#include "slam/image/rectify.h"
#include "slam/parameters.h"
#include "slam/robot.h"

namespace zenith {

using Features = FixedVector<Feature, kMaxCorners>;

class FeatureExtractor {
 public:
  void layout(Arena& arena);
  void build(const RobotConfig& robot, const Parameters& parameters);

  // Whether the frame has pixels, as many as the lens says.
  bool fits(const ImageView& frame) const { return rectifier_.fits(frame); }
  // Features of such a frame, strongest first, at most `corners_max`; valid until the next call.
  // Those of the last frame, as they are by now, when this one repeats it.
  Features& extract(const ImageView& frame, int corners_max = kMaxCorners);
  // Whether the last frame repeats the one before, bit for bit where the rectified image looks, and
  // shows corners. No camera that moves takes one picture twice: it was delivered twice, or driver
  // or sensor hang. A picture without corners may repeat: of a covered lens, or a blank ceiling.
  bool repeated() const { return repeated_; }

  const Pinhole& pinhole() const { return pinhole_; }
  // The rectified image of the last frame.
  ImageView rectified() const {
    return {rectified_.data(), kRectifiedSize, kRectifiedSize, kRectifiedSize};
  }
  bool sees(const Eigen::Vector2d& m, int margin_px) const;

 private:
  Pinhole pinhole_;
  void adapt_threshold(std::size_t corners, int wanted);

  CornerSettings settings_;
  double strongest_threshold_ = 0.0;  // as configured
  Rectifier rectifier_;
  CornerDetector detector_;
  std::span<std::uint8_t> rectified_;
  std::span<std::uint8_t> rectified_before_;
  bool repeated_ = false;
  std::span<Corners> corners_;
  std::span<Features> features_;
};

}  // namespace zenith
