#include "drivers/odometry/replayed_can.h"

#include <algorithm>

#include "platform/linux/clock.h"

namespace zenith {

ReplayedCanBus::ReplayedCanBus(std::vector<CanFrame> frames, const ReplayTiming& timing,
                               const CanIds& ids)
    : frames_(std::move(frames)) {
  const auto rest = std::remove_if(frames_.begin(), frames_.end(),
                                   [&](const CanFrame& frame) { return !passes(frame, ids); });
  frames_.erase(rest, frames_.end());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    frames_[i].stamp = timing.played + (frames_[i].stamp - timing.recorded);
    if (i > 0) frames_[i].stamp = std::max(frames_[i].stamp, frames_[i - 1].stamp);
  }
}

Status ReplayedCanBus::open() {
  close();
  const Time now = monotonic_now();
  while (next_ < frames_.size() && frames_[next_].stamp < now) ++next_;
  state_ = CanState::kUp;
  ++counters_.opened;
  return {};
}

std::size_t ReplayedCanBus::receive(Duration timeout, std::span<CanFrame> out) {
  if (state_ != CanState::kUp || out.empty()) return 0;
  Time now = monotonic_now();
  const Time deadline = can_deadline(now, timeout);
  const Time first = next_ < frames_.size() ? frames_[next_].stamp : deadline;
  if (first > now && deadline > now) {
    sleep_until(std::min(first, deadline));
    now = monotonic_now();
  }
  std::size_t taken = 0;
  while (taken < out.size() && next_ < frames_.size() && frames_[next_].stamp <= now) {
    out[taken++] = frames_[next_++];
  }
  counters_.frames += taken;
  return taken;
}

std::string ReplayedCanBus::description() const {
  return "replayed CAN bus, " + std::to_string(frames_.size()) + " frames";
}

}  // namespace zenith
