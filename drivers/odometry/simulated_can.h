#pragma once
// A CAN bus in memory: a simulated robot's thread sends, the perception thread receives.
//
// Two sides, one thread each. The sender's calls never wait, lock or allocate. A full queue drops
// frames, as the kernel's does, and counts them.

#include <atomic>
#include <cstdint>

#include "drivers/odometry/can_bus.h"
#include "platform/linux/spsc_queue.h"

namespace zenith {

class SimulatedCanBus final : public CanBus {
 public:
  static constexpr std::size_t kCapacity = 512;

  explicit SimulatedCanBus(const CanIds& ids = {}) : ids_(ids) {}

  // The sender's side. Stamps are CLOCK_MONOTONIC and do not go back. Nothing arrives while the bus
  // is closed, off or down.
  void send(const CanFrame& frame);
  void set_bus_off(bool off);
  // False: the interface goes down, and open() fails until it is up again.
  void set_up(bool up);

  Status open() override;
  void close() override;
  std::size_t receive(Duration timeout, std::span<CanFrame> out) override;

  CanState state() const override { return state_; }
  const char* lost_reason() const override;
  std::string description() const override { return "simulated CAN bus"; }
  const CanCounters& counters() const override { return counters_; }

 private:
  std::size_t take(std::span<CanFrame> out);
  void note_state();

  const CanIds ids_;
  SpscQueue<CanFrame, kCapacity> queue_;
  std::atomic<bool> listening_ = false;
  // Odd: off, or down. Every change counts one, so that none is missed.
  std::atomic<std::uint32_t> off_turns_ = 0;
  std::atomic<std::uint32_t> down_turns_ = 0;

  // Of the receiver alone.
  CanState state_ = CanState::kClosed;
  std::uint32_t off_turns_seen_ = 0;
  std::uint32_t down_turns_seen_ = 0;
  std::uint64_t rejected_at_open_ = 0;
  std::uint64_t dropped_before_ = 0;
  CanCounters counters_;
};

}  // namespace zenith
