#pragma once
// The CAN bus of a recording, played in real time.
//
// A frame that was recorded at `timing.recorded + t` arrives at `timing.played + t`; its stamp says
// so. A recording's camera and CAN bus, and all robots of a team, share one timing. What played
// while the bus was closed is over. After the last frame the bus is silent.

#include <cstdint>
#include <vector>

#include "drivers/odometry/can_bus.h"

namespace zenith {

struct ReplayTiming {
  Time recorded;  // a moment on the recording's clock
  Time played;    // CLOCK_MONOTONIC
};

class ReplayedCanBus final : public CanBus {
 public:
  // The frames are in order of arrival; a stamp that goes back is taken as the one before it.
  ReplayedCanBus(std::vector<CanFrame> frames, const ReplayTiming& timing, const CanIds& ids = {});

  Status open() override;
  void close() override { state_ = CanState::kClosed; }
  std::size_t receive(Duration timeout, std::span<CanFrame> out) override;

  CanState state() const override { return state_; }
  std::string description() const override;
  const CanCounters& counters() const override { return counters_; }

  bool finished() const { return next_ == frames_.size(); }

 private:
  std::vector<CanFrame> frames_;  // those that pass the filter, with their stamps of playing
  std::size_t next_ = 0;
  CanState state_ = CanState::kClosed;
  CanCounters counters_;
};

}  // namespace zenith
