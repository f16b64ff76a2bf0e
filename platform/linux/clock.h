#pragma once
// The robot's clock: CLOCK_MONOTONIC, that no one sets. It stands still while the board sleeps.

#include <string>

#include "platform/base/time.h"

namespace zenith {

Time monotonic_now();

// How long the calling thread has computed: what passes beyond that, it waited, or others ran.
Duration thread_cpu_time();

// Returns at once when `wake` has passed. Signals do not shorten it.
void sleep_until(Time wake);

// What the system's clock, CLOCK_REALTIME, is ahead of this one now. Others' programs stamp by it;
// it jumps.
Duration system_clock_offset();

// "2026-03-01 12:34:56.789" UTC, for a person who reads a log. Never compute with it: it jumps.
std::string wall_clock_text();

}  // namespace zenith
