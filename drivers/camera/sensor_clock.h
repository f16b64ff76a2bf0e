#pragma once
// Of which clock libcamera's sensor stamps are.
//
// Its documentation says CLOCK_BOOTTIME; what pipelines hand on are the kernel's stamps of buffers,
// CLOCK_MONOTONIC. The two differ by the time that the board has slept, `asleep`. A stamp that lies
// in the future of CLOCK_MONOTONIC, and not in that of CLOCK_BOOTTIME, is of the latter, and so are
// all later ones of its stream. A board that slept for less than a frame's age is wrong by no more
// than that; one that never slept has one clock.

#include "platform/base/time.h"

namespace zenith {

class SensorClock {
 public:
  void new_stream() { boottime_ = false; }

  // `now` of CLOCK_MONOTONIC. Other clocks still are the caller's to refuse (frame_stamps.h).
  Time to_monotonic(Time stamp, Time now, Duration asleep) {
    if (stamp > now && stamp <= now + asleep) boottime_ = true;
    return boottime_ ? stamp - asleep : stamp;
  }

 private:
  bool boottime_ = false;
};

}  // namespace zenith
