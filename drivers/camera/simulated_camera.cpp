#include "drivers/camera/simulated_camera.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/wait_readable.h"

namespace zenith {

SimulatedCamera::SimulatedCamera(int width_px, int height_px, std::string description,
                                 std::function<void()> on_open)
    : width_px_(width_px),
      height_px_(height_px),
      description_(std::move(description)),
      on_open_(std::move(on_open)),
      event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  for (int i = 0; i < kBuffers; ++i) {
    buffers_[static_cast<std::size_t>(i)].resize(static_cast<std::size_t>(width_px) * height_px);
    free_.push(i);
  }
}

void SimulatedCamera::deliver(Time stamp, std::span<const std::uint8_t> pixels) {
  const std::uint64_t number = sent_++;
  if (!streaming_.load(std::memory_order_acquire)) return;
  int buffer = 0;
  if (!free_.pop(buffer)) return;  // lost: the receiver sees the gap
  auto& target = buffers_[static_cast<std::size_t>(buffer)];
  std::copy_n(pixels.begin(), std::min(pixels.size(), target.size()), target.begin());
  filled_.push({buffer, stamp, number});
  const std::uint64_t one = 1;
  (void)!::write(event_.get(), &one, sizeof one);
}

void SimulatedCamera::deliver_damaged() {
  const std::uint64_t number = sent_++;
  if (streaming_.load(std::memory_order_acquire)) filled_.push({kDamaged, {}, number});
}

Status SimulatedCamera::open() {
  close();
  if (!event_.is_open()) return Error{"simulated camera: no eventfd: " + errno_text(errno)};
  if (!plugged_.load(std::memory_order_acquire)) {
    return Error{"simulated camera: it is not plugged in"};
  }
  // What came before is old.
  Filled old;
  while (filled_.pop(old)) give_back(old);
  counting_ = false;
  lost_reason_ = "";
  period_ = {offered_ns_.load(std::memory_order_relaxed)};
  ++counters_.opened;
  streaming_.store(true, std::memory_order_release);
  on_open_();
  return {};
}

void SimulatedCamera::close() {
  streaming_.store(false, std::memory_order_release);
  give_back_held();
  lost_reason_ = "the camera is not open";
}

void SimulatedCamera::give_back(const Filled& frame) {
  if (frame.buffer != kDamaged) free_.push(frame.buffer);
}

void SimulatedCamera::give_back_held() {
  if (holds_) give_back(held_);
  holds_ = false;
}

bool SimulatedCamera::take_newest() {
  Filled next;
  while (filled_.pop(next)) {
    if (!counting_) first_number_ = next_number_ = next.number;
    counting_ = true;
    counters_.lost_in_driver += next.number - next_number_;
    next_number_ = next.number + 1;
    if (next.buffer == kDamaged) {
      ++counters_.damaged;
      continue;
    }
    if (holds_) ++counters_.skipped;
    give_back_held();
    held_ = next;
    holds_ = true;
  }
  return holds_;
}

CameraWait SimulatedCamera::wait(Duration timeout, CameraFrame& out) {
  if (lost_reason_[0] != '\0') return CameraWait::kLost;
  give_back_held();
  const Time deadline = monotonic_now() + timeout;
  while (!take_newest()) {
    if (!plugged_.load(std::memory_order_acquire)) {
      lost_reason_ = "the simulated camera was unplugged";
      ++counters_.lost;
      return CameraWait::kLost;
    }
    const Time now = monotonic_now();
    if (timeout.ns <= 0 || now >= deadline) return CameraWait::kTimeout;
    wait_readable(event_.get(), deadline - now);
    std::uint64_t count = 0;
    (void)!::read(event_.get(), &count, sizeof count);
  }
  ++counters_.frames;
  out.stamp = held_.stamp;
  out.sequence = held_.number - first_number_;
  out.luma = {buffers_[static_cast<std::size_t>(held_.buffer)].data(), width_px_, height_px_,
              width_px_};
  return CameraWait::kFrame;
}

}  // namespace zenith
