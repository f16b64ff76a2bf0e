#include "platform/daemon/tap/tap.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace zenith::tap {

Tap::Tap(int width, int height, int frames)
    : width_(width),
      height_(height),
      frame_bytes_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      memory_(frame_bytes_ * static_cast<std::size_t>(frames), std::uint8_t{0}) {
  assert(width > 0 && height > 0 && frames >= 1 && frames <= kMaxFrames);
  for (int slot = 0; slot < frames; ++slot) free_.push(slot);
}

void Tap::add(const CameraFrame& frame) {
  const std::uint32_t session = session_.load(std::memory_order_acquire);
  if (session == 0 || frame.luma.width != width_ || frame.luma.height != height_) return;
  FilledSlot filled;
  if (!free_.pop(filled.slot)) {
    frames_dropped_.store(frames_dropped_.load(std::memory_order_relaxed) + 1,
                          std::memory_order_relaxed);
    return;
  }
  filled.session = session;
  filled.head = {frame.stamp, frame.sequence, width_, height_};
  std::uint8_t* to = pixels_of(filled.slot);
  if (frame.luma.stride == width_) {
    std::memcpy(to, frame.luma.data, frame_bytes_);
  } else {
    const auto row = static_cast<std::size_t>(width_);
    for (int v = 0; v < height_; ++v) {
      std::memcpy(to + static_cast<std::size_t>(v) * row, frame.luma.row(v), row);
    }
  }
  filled_.push(filled);  // as many places as slots: never full
}

void Tap::add(const CanFrame& frame) {
  const std::uint32_t session = session_.load(std::memory_order_acquire);
  if (session != 0) can_.push({session, frame});
}

void Tap::add(const TappedPose& pose) {
  const std::uint32_t session = session_.load(std::memory_order_acquire);
  if (session != 0) poses_.push({session, pose});
}

void Tap::start() {
  if (++last_session_ == 0) ++last_session_;
  TappedFrame old_frame;
  CanFrame old_can;
  TappedPose old_pose;
  while (next(old_frame)) give_back(old_frame);  // all are of older sessions, so none comes out
  while (next(old_can)) {
  }
  while (next(old_pose)) {
  }
  before_ = rejected();
  session_.store(last_session_, std::memory_order_release);
}

void Tap::stop() {
  session_.store(0, std::memory_order_release);
}

bool Tap::next(TappedFrame& out) {
  FilledSlot filled;
  while (filled_.pop(filled)) {
    out = {filled.head, pixels_of(filled.slot), filled.slot};
    if (filled.session == last_session_) return true;
    give_back(out);
  }
  return false;
}

bool Tap::next(CanFrame& out) {
  MarkedCan marked;
  while (can_.pop(marked)) {
    out = marked.frame;
    if (marked.session == last_session_) return true;
  }
  return false;
}

bool Tap::next(TappedPose& out) {
  MarkedPose marked;
  while (poses_.pop(marked)) {
    out = marked.pose;
    if (marked.session == last_session_) return true;
  }
  return false;
}

Drops Tap::rejected() const {
  return {frames_dropped_.load(std::memory_order_relaxed), can_.rejected(), poses_.rejected()};
}

Drops Tap::drops() const {
  const Drops now = rejected();
  return {now.frames - before_.frames, now.can - before_.can, now.poses - before_.poses};
}

}  // namespace zenith::tap
