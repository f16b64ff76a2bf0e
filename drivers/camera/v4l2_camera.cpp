#include "drivers/camera/v4l2_camera.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "drivers/camera/v4l2_controls.h"
#include "drivers/camera/v4l2_enumerate.h"
#include "drivers/camera/v4l2_negotiation.h"

namespace zenith {
namespace {

constexpr double kStallPeriods = 3.0;
constexpr int kStalePeriods = 3;
constexpr Duration kMaxTimeout = {std::int64_t{3600} * 1'000'000'000};

Status check_captures(const V4l2Offer& offer) {
  const std::string name = offer.path + " (" + offer.card + ")";
  if (!offer.captures) {
    return Error{name + (offer.has_output
                             ? " takes frames and gives none: a loop-back device whose writer has "
                               "not started, or a codec; start the writer"
                             : " does not capture video; cameras often have several nodes, try "
                               "another, or \"name:...\"")};
  }
  if (!offer.streams) return Error{name + " has no memory-mapped streaming; another is needed"};
  return {};
}

const char* loss_of(int error) {
  switch (error) {
    case ENODEV:
    case ENXIO:
      return "the camera was unplugged (ENODEV)";
    case EIO:
      return "the stream failed (EIO)";
    case EPIPE:
      return "the stream ended (EPIPE)";
    case EINVAL:
      return "the driver stopped the stream (EINVAL)";
    case EPROTO:
      return "the driver gave a buffer that does not exist";
    default:
      return "the driver reported an error";
  }
}

}  // namespace

V4l2Camera::V4l2Camera(const V4l2Settings& settings, V4l2Io& io) : settings_(settings), io_(io) {}

Status V4l2Camera::open() {
  close();
  Status status = check_settings(settings_);
  if (status) status = start();
  if (!status) close();
  return status;
}

Status V4l2Camera::start() {
  const auto path = find_v4l2_device(io_, settings_.device);
  if (!path) return path.error();
  auto device = open_v4l2_device(io_, *path);
  if (!device) return device.error();
  device_ = std::move(*device);
  const auto offer = enumerate_v4l2(device_, *path, settings_.width, settings_.height);
  if (!offer) return offer.error();
  const Status captures = check_captures(*offer);
  if (!captures) return captures;
  const auto mode = negotiate_v4l2(*offer, settings_);
  if (!mode) return mode.error();
  auto agreed = set_v4l2_mode(device_, *offer, *mode, settings_.rate_hz);
  if (!agreed) return agreed.error();
  agreed_ = std::move(*agreed);

  warnings_ = mode->warnings;
  warnings_.insert(warnings_.end(), agreed_.warnings.begin(), agreed_.warnings.end());
  const auto unset = apply_v4l2_controls(device_, settings_);
  warnings_.insert(warnings_.end(), unset.begin(), unset.end());
  const double rate_hz = agreed_.rate_hz > 0.0 ? agreed_.rate_hz : settings_.rate_hz;
  description_ = "V4L2 " + *path + " (" + offer->card + "), " + fourcc_text(agreed_.luma.fourcc) +
                 " " + std::to_string(agreed_.width) + "x" + std::to_string(agreed_.height) + ", " +
                 rate_text(rate_hz);
  const bool in_place = agreed_.luma.layout == LumaLayout::kPlane && !settings_.copy;
  copy_.assign(in_place ? 0 : std::size_t(agreed_.width) * agreed_.height, 0);

  Status streams = stream_.start(device_, *path + " (" + offer->card + ")", offer->multiplanar,
                                 settings_.buffers, agreed_.needed_bytes);
  if (!streams) return streams;
  stamps_.new_stream();
  sequence_.reset();
  begun_ = false;
  period_ = Duration::from_seconds(1.0 / rate_hz);
  stall_ = Duration::from_seconds(std::max(settings_.stall_s, kStallPeriods / rate_hz));
  patience_ = std::max(stall_, Duration::from_seconds(settings_.first_frame_s));
  last_alive_ = io_.now();
  lost_reason_ = nullptr;
  ++counters_.opened;
  return {};
}

void V4l2Camera::close() {
  stream_.stop();
  device_.close();
  holds_ = false;
  lost_reason_ = "the camera is not open";
}

CameraWait V4l2Camera::wait(Duration timeout, CameraFrame& out) {
  if (lost_reason_ != nullptr || !give_back_held()) return CameraWait::kLost;
  const Time deadline = io_.now() + std::clamp(timeout, Duration{0}, kMaxTimeout);
  for (bool waited = false;; waited = true) {
    if (!drain()) return CameraWait::kLost;
    const Time now = io_.now();
    if (holds_ && (waited || now >= deadline || !is_stale(now))) return deliver(now, out);
    if (now >= deadline) return CameraWait::kTimeout;
    if (!poll_until(deadline, now)) return CameraWait::kLost;
  }
}

bool V4l2Camera::give_back_held() {
  if (!holds_) return true;
  holds_ = false;
  const int result = stream_.give_back(held_.index);
  if (result < 0) lose(loss_of(-result));
  return result >= 0;
}

// Takes all that is finished and keeps the newest good frame. False when the camera is lost.
//
// The first frame of a stream is passed over: loop-back devices give the last picture of an earlier
// stream with a stamp of now, and sensors have not settled yet.
bool V4l2Camera::drain() {
  for (taken_at_once_ = 0;; ++taken_at_once_) {
    V4l2Taken taken;
    const int result = stream_.take(taken);
    if (result == -EAGAIN) return true;
    if (result < 0) {
      lose(loss_of(-result));
      return false;
    }
    const bool first = !std::exchange(begun_, true);
    FrameSequence::Step step;
    if (!first) step = sequence_.advance(taken.sequence);
    counters_.lost_in_driver += step.lost;
    const bool damaged = taken.error || taken.bytes < agreed_.needed_bytes;
    if (damaged || first) {
      if (damaged) ++counters_.damaged;
      const int queued = stream_.give_back(taken.index);
      if (queued >= 0) continue;
      lose(loss_of(-queued));
      return false;
    }
    if (holds_) ++counters_.skipped;
    if (!give_back_held()) return false;
    held_ = taken;
    held_number_ = step.number;
    holds_ = true;
  }
}

// The driver had no empty buffer any more, so that newer frames could not come.
bool V4l2Camera::is_stale(Time now) const {
  const bool starved = taken_at_once_ + 1 >= stream_.buffers();
  return starved && held_.stamp < now - Duration{kStalePeriods * period_.ns};
}

CameraWait V4l2Camera::deliver(Time now, CameraFrame& out) {
  const FrameStamps::Judged judged = stamps_.judge(held_.stamp, held_.stamp_monotonic, now);
  if (judged.replaced) ++counters_.stamps_replaced;
  const std::uint8_t* raw = stream_.data(held_.index) + held_.offset;
  out.stamp = judged.stamp;
  out.sequence = held_number_;
  out.luma = {raw, agreed_.width, agreed_.height, static_cast<std::ptrdiff_t>(agreed_.stride)};
  if (!copy_.empty()) {
    const MutableImageView copy = {copy_.data(), agreed_.width, agreed_.height, agreed_.width};
    extract_luma(agreed_.luma.layout, raw, agreed_.stride, copy);
    out.luma = copy;
  }
  ++counters_.frames;
  last_alive_ = now;
  patience_ = stall_;
  return CameraWait::kFrame;
}

// Sleeps until a frame comes, the deadline or the end of patience. False when the camera is lost.
bool V4l2Camera::poll_until(Time deadline, Time now) {
  const Time stalled = last_alive_ + patience_;
  if (now >= stalled && !holds_) {
    ++counters_.stalled;
    lose("no good frame came for too long");
    return false;
  }
  const Duration until =
      std::max((holds_ ? deadline : std::min(deadline, stalled)) - now, Duration{0});
  const int events = io_.poll(device_.fd(), until);
  if (events < 0) {
    lose(loss_of(-events));
    return false;
  }
  if ((events & (POLLERR | POLLHUP | POLLNVAL)) == 0) return true;
  lose("the driver reported an error while it was waited for a frame (POLLERR)");
  return false;
}

void V4l2Camera::lose(const char* reason) {
  lost_reason_ = reason;
  ++counters_.lost;
}

}  // namespace zenith
