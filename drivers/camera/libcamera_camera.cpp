#include "drivers/camera/libcamera_camera.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include <libcamera/control_ids.h>

#include "drivers/camera/libcamera_controls.h"
#include "drivers/camera/vanished_device.h"
#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/wait_readable.h"

namespace zenith {
namespace {

constexpr double kStallPeriods = 3.0;
constexpr int kStalePeriods = 3;
constexpr Duration kMaxTimeout = {std::int64_t{3600} * 1'000'000'000};

void signal(const UniqueFd& event) {
  const std::uint64_t one = 1;
  (void)!::write(event.get(), &one, sizeof one);
}

void wait_for(const UniqueFd& event, Duration timeout) {
  wait_readable(event.get(), timeout);
  std::uint64_t count = 0;
  (void)!::read(event.get(), &count, sizeof count);
}

// How far CLOCK_BOOTTIME is ahead of CLOCK_MONOTONIC.
Duration time_asleep(Time now) {
  timespec boot = {};
  ::clock_gettime(CLOCK_BOOTTIME, &boot);
  return Time{boot.tv_sec * 1'000'000'000LL + boot.tv_nsec} - now;
}

std::string rate_text(double rate_hz) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g/s", rate_hz);
  return text;
}

}  // namespace

Status LibcameraCamera::open() {
  close();
  Status status = check_settings(settings_);
  if (counters_.abandoned >= kMaxAbandoned) {
    status =
        Error{"the device of libcamera's camera vanished " + std::to_string(counters_.abandoned) +
              " times, and each time libcamera kept memory and descriptors; restart zenithd, "
              "and look at the camera's cable and power"};
  }
  if (status) status = start();
  if (!status) close();
  return status;
}

Status LibcameraCamera::start() {
  finished_event_ = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  returned_event_ = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!finished_event_.is_open() || !returned_event_.is_open()) {
    return Error{"libcamera: no eventfd: " + errno_text(errno)};
  }
  // Made anew each time, which finds cameras that came late also where no udev tells of them.
  manager_ = std::make_unique<libcamera::CameraManager>();
  const int managed = manager_->start();
  if (managed < 0) return Error{"libcamera does not start: " + errno_text(-managed)};
  auto camera = find_libcamera_camera(*manager_, settings_.device);
  if (!camera) return camera.error();
  camera_ = std::move(*camera);
  const int acquired = camera_->acquire();
  if (acquired < 0) {
    const std::string name = libcamera_name(*camera_);
    camera_.reset();
    return Error{name + " cannot be taken: " + errno_text(-acquired) +
                 "; another program may use it"};
  }
  Status status = agree();
  if (status) status = make_requests();
  if (status) status = start_stream();
  return status;
}

Status LibcameraCamera::agree() {
  auto mode = negotiate_libcamera(*camera_, settings_);
  if (!mode) return mode.error();
  mode_ = std::move(*mode);
  const int configured = camera_->configure(mode_.configuration.get());
  if (configured < 0) {
    return Error{libcamera_name(*camera_) + " refuses " + mode_.configuration->at(0).toString() +
                 ": " + errno_text(-configured)};
  }
  const libcamera::StreamConfiguration& stream = mode_.configuration->at(0);
  const std::size_t row_bytes = mode_.luma.bytes_per_pixel() * settings_.width;
  stride_ = stream.stride == 0 ? row_bytes : stream.stride;
  if (stride_ < row_bytes) {
    return Error{libcamera_name(*camera_) + ": rows of " + stream.toString() + " need " +
                 std::to_string(row_bytes) + " bytes, it says " + std::to_string(stride_)};
  }
  needed_bytes_ = mode_.luma.needed_bytes(settings_.width, settings_.height, stride_);
  const bool in_place = mode_.luma.layout == LumaLayout::kPlane && !settings_.copy;
  copy_.assign(in_place ? 0 : std::size_t(settings_.width) * settings_.height, 0);
  return {};
}

Status LibcameraCamera::make_requests() {
  const std::string name = libcamera_name(*camera_);
  libcamera::Stream* stream = mode_.configuration->at(0).stream();
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  const int allocated = allocator_->allocate(stream);
  if (allocated < 0) return Error{name + ": cannot get buffers: " + errno_text(-allocated)};
  for (const auto& buffer : allocator_->buffers(stream)) {
    if (requests_.size() == kQueued) break;
    Status mapped = buffers_.map(name, *buffer, needed_bytes_);
    if (!mapped) return mapped;
    auto request = camera_->createRequest(requests_.size());
    if (!request || request->addBuffer(stream, buffer.get()) < 0) {
      return Error{name + ": cannot make a request for a frame"};
    }
    requests_.push_back(std::move(request));
  }
  if (requests_.size() >= 2) return {};
  return Error{name + " gave " + std::to_string(requests_.size()) +
               " buffers, at least 2 are needed; free memory, or ask for a smaller size"};
}

Status LibcameraCamera::start_stream() {
  LibcameraControls controls = choose_libcamera_controls(*camera_, settings_);
  const double rate_hz = controls.rate_hz > 0.0 ? controls.rate_hz : settings_.rate_hz;
  warnings_ = std::move(controls.warnings);
  const libcamera::StreamConfiguration& stream = mode_.configuration->at(0);
  description_ = "libcamera " + libcamera_name(*camera_) + ", " + stream.pixelFormat.toString() +
                 " " + std::to_string(settings_.width) + "x" + std::to_string(settings_.height) +
                 ", " + rate_text(rate_hz);
  stop_.store(false);
  failure_.store(nullptr);
  disconnected_.store(false);
  camera_->requestCompleted.connect(this, &LibcameraCamera::finished);
  camera_->disconnected.connect(this, &LibcameraCamera::disconnected);
  streaming_ = true;
  const int started = camera_->start(&controls.list);
  if (started < 0) {
    return Error{libcamera_name(*camera_) + ": the stream does not start: " + errno_text(-started)};
  }
  for (const auto& request : requests_) {
    const int queued = camera_->queueRequest(request.get());
    if (queued < 0) {
      return Error{libcamera_name(*camera_) + ": cannot queue a request: " + errno_text(-queued)};
    }
  }
  Report report;
  Status giver = giver_.start(
      {.name = "libcamera-give", .stack_bytes = std::size_t{512} * 1024},
      [this] { give_back_requests(); }, report);
  if (!giver) return giver;
  stamps_.new_stream();
  clock_.new_stream();
  sequence_.reset();
  period_ = Duration::from_seconds(1.0 / rate_hz);
  agreed_period_ = controls.rate_hz > 0.0 ? period_ : Duration{0};
  stall_ = Duration::from_seconds(std::max(settings_.stall_s, kStallPeriods / rate_hz));
  patience_ = std::max(stall_, Duration::from_seconds(settings_.first_frame_s));
  last_alive_ = monotonic_now();
  lost_reason_ = nullptr;
  ++counters_.opened;
  return {};
}

void LibcameraCamera::close() {
  if (holds_) buffers_.end_read(held_.index);
  holds_ = false;
  lost_reason_ = "the camera is not open";
  stop_.store(true);
  if (returned_event_.is_open()) signal(returned_event_);
  giver_.join();
  if (camera_) end_stream();
  if (manager_) manager_->stop();
  manager_.reset();
  Finished old;
  while (finished_.pop(old)) {
  }
  std::uint32_t index = 0;
  while (returned_.pop(index)) {
  }
}

// All that is libcamera's goes before its manager.
void LibcameraCamera::end_stream() {
  if (streaming_ && (disconnected_.load() || has_vanished(open_video_devices()))) {
    return abandon_stream();
  }
  if (streaming_) {
    camera_->stop();
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
  }
  streaming_ = false;
  requests_.clear();
  buffers_.unmap();
  allocator_.reset();
  mode_ = {};
  camera_->release();
  camera_.reset();
}

// What libcamera may still look at stays where it is, for ever. Its thread ends with the manager.
void LibcameraCamera::abandon_stream() {
  struct Abandoned {
    std::shared_ptr<libcamera::Camera> camera;
    std::unique_ptr<libcamera::FrameBufferAllocator> allocator;
    std::vector<std::unique_ptr<libcamera::Request>> requests;
    std::unique_ptr<libcamera::CameraConfiguration> configuration;
  };
  static auto& all = *new std::vector<Abandoned>;  // not destroyed at the program's end either
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  streaming_ = false;
  buffers_.unmap();
  all.push_back({std::move(camera_), std::move(allocator_), std::move(requests_),
                 std::move(mode_.configuration)});
  camera_.reset();
  requests_.clear();
  mode_ = {};
  ++counters_.abandoned;
}

void LibcameraCamera::finished(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;  // at the stream's end
  const libcamera::FrameMetadata& metadata = request->buffers().begin()->second->metadata();
  const auto stamp = request->metadata().get(libcamera::controls::SensorTimestamp);
  Finished news;
  news.index = static_cast<std::uint32_t>(request->cookie());
  news.sequence = metadata.sequence;
  news.bytes = metadata.planes().empty() ? 0 : metadata.planes().begin()->bytesused;
  news.stamp = Time{stamp ? *stamp : static_cast<std::int64_t>(metadata.timestamp)};
  news.good = metadata.status == libcamera::FrameMetadata::FrameSuccess;
  finished_.push(news);  // has room for all buffers
  signal(finished_event_);
}

void LibcameraCamera::disconnected() {
  disconnected_.store(true);
  failure_.store("the camera was unplugged");
  signal(finished_event_);
}

void LibcameraCamera::give_back_requests() {
  constexpr Duration kLook = {100'000'000};
  while (!stop_.load()) {
    wait_for(returned_event_, kLook);
    std::uint32_t index = 0;
    while (!stop_.load() && returned_.pop(index)) {
      libcamera::Request* request = requests_[index].get();
      request->reuse(libcamera::Request::ReuseBuffers);
      if (camera_->queueRequest(request) >= 0) continue;
      failure_.store("libcamera takes no more requests");
      signal(finished_event_);
    }
  }
}

CameraWait LibcameraCamera::wait(Duration timeout, CameraFrame& out) {
  if (lost_reason_ != nullptr) return CameraWait::kLost;
  give_back_held();
  const Time deadline = monotonic_now() + std::clamp(timeout, Duration{0}, kMaxTimeout);
  for (bool waited = false;; waited = true) {
    drain();
    const Time now = monotonic_now();
    if (holds_ && (waited || now >= deadline || !is_stale(now))) return deliver(now, out);
    if (!check_alive(now)) return CameraWait::kLost;
    if (now >= deadline) return CameraWait::kTimeout;
    const Time until = holds_ ? deadline : std::min(deadline, last_alive_ + patience_);
    wait_for(finished_event_, until - now);
  }
}

void LibcameraCamera::give_back(std::uint32_t index) {
  returned_.push(index);  // has room for all buffers
  signal(returned_event_);
}

void LibcameraCamera::give_back_held() {
  if (!holds_) return;
  holds_ = false;
  buffers_.end_read(held_.index);
  give_back(held_.index);
}

// Takes all that is finished and keeps the newest good frame.
void LibcameraCamera::drain() {
  Finished next;
  for (taken_at_once_ = 0; finished_.pop(next); ++taken_at_once_) {
    const FrameSequence::Step step = sequence_.advance(next.sequence);
    counters_.lost_in_driver += step.lost;
    if (!next.good || next.bytes < needed_bytes_) {
      ++counters_.damaged;
      give_back(next.index);
      continue;
    }
    if (holds_) ++counters_.skipped;
    give_back_held();
    buffers_.begin_read(next.index);
    held_ = next;
    held_number_ = step.number;
    holds_ = true;
  }
}

// The camera had no empty buffer any more, so that newer frames could not come.
bool LibcameraCamera::is_stale(Time now) const {
  const bool starved = taken_at_once_ + 1 >= buffers_.size();
  return starved && held_.stamp < now - Duration{kStalePeriods * period_.ns};
}

CameraWait LibcameraCamera::deliver(Time now, CameraFrame& out) {
  const Time stamp = clock_.to_monotonic(held_.stamp, now, time_asleep(now));
  const FrameStamps::Judged judged = stamps_.judge(stamp, false, now);
  if (judged.replaced) ++counters_.stamps_replaced;
  const std::uint8_t* raw = buffers_.data(held_.index);
  out.stamp = judged.stamp;
  out.sequence = held_number_;
  out.luma = {raw, settings_.width, settings_.height, static_cast<std::ptrdiff_t>(stride_)};
  if (!copy_.empty()) {
    const MutableImageView copy = {copy_.data(), settings_.width, settings_.height,
                                   settings_.width};
    extract_luma(mode_.luma.layout, raw, stride_, copy);
    out.luma = copy;
  }
  ++counters_.frames;
  last_alive_ = now;
  patience_ = stall_;
  return CameraWait::kFrame;
}

bool LibcameraCamera::check_alive(Time now) {
  const char* failure = failure_.load();
  const bool stalled = failure == nullptr && !holds_ && now >= last_alive_ + patience_;
  if (stalled) {
    ++counters_.stalled;
    failure = "no good frame came for too long";
  }
  if (failure == nullptr) return true;
  lost_reason_ = failure;
  ++counters_.lost;
  return false;
}

}  // namespace zenith
