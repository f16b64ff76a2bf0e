#include "drivers/odometry/simulated_can.h"

#include <algorithm>

#include "platform/linux/clock.h"

namespace zenith {
namespace {

// How often a waiting receiver looks.
constexpr Duration kLook = {500'000};

constexpr bool is_odd(std::uint32_t turns) {
  return turns % 2 != 0;
}

// One thread writes.
void turn(std::atomic<std::uint32_t>& turns, bool odd) {
  const std::uint32_t now = turns.load(std::memory_order_relaxed);
  if (is_odd(now) != odd) turns.store(now + 1, std::memory_order_release);
}

}  // namespace

void SimulatedCanBus::send(const CanFrame& frame) {
  const bool heard = listening_.load(std::memory_order_acquire) &&
                     !is_odd(down_turns_.load(std::memory_order_relaxed)) &&
                     !is_odd(off_turns_.load(std::memory_order_relaxed));
  if (heard && passes(frame, ids_)) queue_.push(frame);
}

void SimulatedCanBus::set_bus_off(bool off) {
  turn(off_turns_, off);
}

void SimulatedCanBus::set_up(bool up) {
  turn(down_turns_, !up);
}

Status SimulatedCanBus::open() {
  close();
  down_turns_seen_ = down_turns_.load(std::memory_order_acquire);
  if (is_odd(down_turns_seen_)) {
    return Error{"simulated CAN bus: it is down; open it again when it is up"};
  }
  CanFrame old;
  while (queue_.pop(old)) {
  }
  off_turns_seen_ = off_turns_.load(std::memory_order_acquire);
  state_ = is_odd(off_turns_seen_) ? CanState::kBusOff : CanState::kUp;
  dropped_before_ = counters_.dropped;
  rejected_at_open_ = queue_.rejected();
  ++counters_.opened;
  listening_.store(true, std::memory_order_release);
  return {};
}

void SimulatedCanBus::close() {
  listening_.store(false, std::memory_order_release);
  state_ = CanState::kClosed;
}

std::size_t SimulatedCanBus::receive(Duration timeout, std::span<CanFrame> out) {
  if (out.empty()) return 0;
  const Time deadline = can_deadline(monotonic_now(), timeout);
  while (state_ == CanState::kUp || state_ == CanState::kBusOff) {
    const std::size_t taken = take(out);
    note_state();
    const Time now = monotonic_now();
    if (taken > 0 || now >= deadline) return taken;
    sleep_until(std::min(deadline, now + kLook));
  }
  return 0;
}

std::size_t SimulatedCanBus::take(std::span<CanFrame> out) {
  std::size_t taken = 0;
  while (taken < out.size() && queue_.pop(out[taken])) ++taken;
  counters_.frames += taken;
  counters_.dropped = dropped_before_ + (queue_.rejected() - rejected_at_open_);
  return taken;
}

void SimulatedCanBus::note_state() {
  const std::uint32_t turns = off_turns_.load(std::memory_order_acquire);
  for (; off_turns_seen_ != turns; ++off_turns_seen_) {
    ++counters_.error_frames;
    ++(is_odd(off_turns_seen_) ? counters_.restarted : counters_.bus_off);
  }
  state_ = is_odd(turns) ? CanState::kBusOff : CanState::kUp;
  if (down_turns_.load(std::memory_order_acquire) == down_turns_seen_) return;
  state_ = CanState::kDown;
  ++counters_.lost;
}

const char* SimulatedCanBus::lost_reason() const {
  return state_ == CanState::kDown ? "the simulated bus went down" : "";
}

}  // namespace zenith
