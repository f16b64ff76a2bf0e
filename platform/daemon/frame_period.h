#pragma once
// The period of the camera's frames, which is what a frame's step may take. The first that is
// known:
//
//   measured    median of the last kIntervals intervals between stamps, divided by how many frames
//               the camera counted in each: frames that were passed over or lost do not matter
//   agreed      what the driver says that it agreed on with the device
//   wished      camera.rate_hz
//
// Plain data, no heap.

#include <algorithm>
#include <array>
#include <cstdint>

#include "platform/base/time.h"

namespace zenith {

class FramePeriod {
 public:
  static constexpr std::size_t kIntervals = 15;
  static constexpr std::size_t kLeast = 5;  // fewer are no measurement

  explicit FramePeriod(Duration wished) : value_(wished), wished_(wished) {}

  // The camera was opened. `agreed`: of Camera::period(), 0 when the driver does not say.
  void begin(Duration agreed) {
    agreed_ = agreed;
    measured_ = {0};
    count_ = 0;
    begun_ = false;
    value_ = agreed.ns > 0 ? agreed : wished_;
  }

  // Of each frame: CameraFrame's.
  void note(Time stamp, std::uint64_t sequence) {
    const bool rises = begun_ && sequence > sequence_ && stamp > stamp_;
    if (rises) add((stamp - stamp_).ns / static_cast<std::int64_t>(sequence - sequence_));
    begun_ = true;
    stamp_ = stamp;
    sequence_ = sequence;
  }

  Duration value() const { return value_; }        // above zero
  Duration agreed() const { return agreed_; }      // 0: not known
  Duration measured() const { return measured_; }  // likewise

 private:
  void add(std::int64_t interval_ns) {
    intervals_ns_[count_++ % kIntervals] = std::max<std::int64_t>(interval_ns, 1);
    const std::size_t known = std::min<std::size_t>(count_, kIntervals);
    if (known < kLeast) return;
    auto sorted = intervals_ns_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(known / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(known));
    value_ = measured_ = {*middle};
  }

  Duration value_;
  Duration wished_;
  Duration agreed_ = {0};
  Duration measured_ = {0};
  std::array<std::int64_t, kIntervals> intervals_ns_ = {};
  std::uint64_t count_ = 0;
  bool begun_ = false;
  Time stamp_;
  std::uint64_t sequence_ = 0;
};

}  // namespace zenith
