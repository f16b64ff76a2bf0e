#pragma once
// From a base's CAN frames to the total travel of its wheels.
//
//   travel += unit * (int32)(counter - previous counter)        modulo 2^32, so a wrap is a step
//
// A step that no wheel can make (faster than max_wheel_speed_mps since the last frame) is a
// restart of the base or of its counters: the total goes on from where it was, without motion, and
// the restart is counted.

#include <cstdint>
#include <optional>

#include "drivers/odometry/can_frame.h"
#include "slam/wheels.h"

namespace zenith {

struct WheelDecoderConfig {
  double max_wheel_speed_mps = 5.0;
};

struct WheelDecoderCounters {
  std::uint64_t samples = 0;
  std::uint64_t resets = 0;         // implausible steps: counters restarted
  std::uint64_t late = 0;           // stamp not newer than the last odometer frame: refused
  std::uint64_t short_frames = 0;   // known identifier, too few bytes: refused
  std::uint64_t unknown_ids = 0;    // not a frame of this base: ignored
  std::uint64_t motion_frames = 0;  // 0x221: known, carries no travel
};

// AgileX v2. Plain data, no heap; one caller at a time.
class WheelDecoder {
 public:
  explicit WheelDecoder(const WheelDecoderConfig& config = {}) : config_(config) {}

  // A sample for each accepted odometer frame; the first one has zero travel.
  std::optional<WheelSample> decode(const CanFrame& frame);

  const WheelDecoderCounters& counters() const { return counters_; }

 private:
  WheelDecoderConfig config_;
  WheelDecoderCounters counters_;
  bool started_ = false;
  Time last_stamp_;
  std::uint32_t last_left_ = 0;
  std::uint32_t last_right_ = 0;
  std::int64_t total_left_mm_ = 0;
  std::int64_t total_right_mm_ = 0;
};

}  // namespace zenith
