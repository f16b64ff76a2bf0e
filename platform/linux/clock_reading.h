#pragma once
// How this computer's clocks lie against each other at a moment. CLOCK_MONOTONIC, which stamps
// everything, begins anew at each start and stands still while the board sleeps; of two computers
// only the wall clocks can be compared.

#include "platform/base/time.h"

namespace zenith {

struct ClockReading {
  Time monotonic;
  Duration suspended;         // in which the board slept since its start: CLOCK_BOOTTIME is ahead
  Duration wall;              // CLOCK_REALTIME is ahead of CLOCK_MONOTONIC
  bool synchronised = false;  // the kernel says that NTP, or the like, keeps the wall clock

  bool operator==(const ClockReading&) const = default;
};

// Exact to some microseconds.
ClockReading read_clocks();

}  // namespace zenith
