#include "drivers/odometry/wheel_decoder.h"

#include <cmath>

#include "drivers/odometry/agilex_v2.h"

namespace zenith {
namespace {

constexpr double kMetresPerCount = 0.001;
// Counters move in whole millimetres and stamps carry jitter: two frames close together may show
// a step that their stamps alone would forbid.
constexpr double kStepSlack_m = 0.010;

std::int64_t counter_step(std::uint32_t now, std::uint32_t before) {
  return static_cast<std::int32_t>(now - before);
}

}  // namespace

std::optional<WheelSample> WheelDecoder::decode(const CanFrame& frame) {
  const bool odometer = !frame.extended && frame.id == agilex_v2::kOdometerId;
  const bool motion = !frame.extended && frame.id == agilex_v2::kMotionId;
  if (!odometer) {
    motion ? ++counters_.motion_frames : ++counters_.unknown_ids;
    return std::nullopt;
  }
  const auto counts = agilex_v2::decode_odometer(frame);
  if (!counts) {
    ++counters_.short_frames;
    return std::nullopt;
  }
  if (started_ && frame.stamp <= last_stamp_) {
    ++counters_.late;
    return std::nullopt;
  }
  const auto left = static_cast<std::uint32_t>(counts->left_mm);
  const auto right = static_cast<std::uint32_t>(counts->right_mm);
  if (started_) {
    const std::int64_t step_left = counter_step(left, last_left_);
    const std::int64_t step_right = counter_step(right, last_right_);
    const double limit_m =
        config_.max_wheel_speed_mps * (frame.stamp - last_stamp_).seconds() + kStepSlack_m;
    const auto possible = [limit_m](std::int64_t step) {
      return std::abs(static_cast<double>(step)) * kMetresPerCount <= limit_m;
    };
    if (possible(step_left) && possible(step_right)) {
      total_left_mm_ += step_left;
      total_right_mm_ += step_right;
    } else {
      ++counters_.resets;
    }
  }
  started_ = true;
  last_stamp_ = frame.stamp;
  last_left_ = left;
  last_right_ = right;
  ++counters_.samples;
  return WheelSample{frame.stamp, kMetresPerCount * static_cast<double>(total_left_mm_),
                     kMetresPerCount * static_cast<double>(total_right_mm_)};
}

}  // namespace zenith
