#pragma once
// A CAN bus, real, simulated or replayed, as the perception thread sees it.
//
// open() and close() may allocate and belong to a thread without deadlines. receive() is for the
// realtime thread: no heap, no lock, no log. One caller at a time.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/odometry/can_frame.h"
#include "platform/base/result.h"
#include "platform/base/time.h"

namespace zenith {

struct CanCounters {
  std::uint64_t frames = 0;           // delivered by receive()
  std::uint64_t dropped = 0;          // by the kernel, its queue being full
  std::uint64_t error_frames = 0;     // of the controller
  std::uint64_t bus_off = 0;          // the controller left the bus
  std::uint64_t restarted = 0;        // and came back
  std::uint64_t ignored = 0;          // remote and FD frames
  std::uint64_t stamps_replaced = 0;  // implausible stamps, replaced by "now"
  std::uint64_t opened = 0;
  std::uint64_t lost = 0;  // interface went down or away
};

enum class CanState {
  kClosed,
  kUp,
  kBusOff,  // still open; comes back by itself when the controller is restarted
  kDown,    // the interface is down or gone: close() and open() again
};

// When a receive() of this timeout ends: at once for zero and less, at most an hour later.
constexpr Time can_deadline(Time now, Duration timeout) {
  constexpr Duration kHour = {std::int64_t{3600} * 1'000'000'000};
  return now + std::clamp(timeout, Duration{0}, kHour);
}

class CanBus {
 public:
  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;
  virtual ~CanBus() = default;

  virtual Status open() = 0;
  virtual void close() = 0;

  // Waits up to `timeout` (0: not at all) for a first frame, then takes what is there. Returns how
  // many were written; data frames only, in order of arrival; their stamps, on CLOCK_MONOTONIC,
  // never go back. When closed or kDown it returns 0 at once.
  virtual std::size_t receive(Duration timeout, std::span<CanFrame> out) = 0;

  // As receive() last saw it.
  virtual CanState state() const = 0;
  // Why it is kDown, a static text for the log; empty while it is not.
  virtual const char* lost_reason() const { return ""; }
  virtual std::string description() const = 0;
  virtual const CanCounters& counters() const = 0;
};

}  // namespace zenith
