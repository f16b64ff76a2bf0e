#pragma once
// A camera of libcamera.
//
// libcamera's thread hands finished requests through a lock-free queue to wait(). Giving a request
// back allocates and locks, so a thread of our own does it. Grey and YUV frames are used where they
// lie; others cost one copy (luma_format.h). Stamps: sensor_clock.h, then frame_stamps.h.
//
// A device that vanishes leaves its requests queued in libcamera, which (0.0.3) ends the whole
// process by an assertion when such a stream is stopped, and may when its camera is destroyed. So
// it is abandoned: never stopped, never destroyed, and what it holds (some twenty descriptors, a
// few megabytes) stays taken until the program ends. The next open() begins with a manager of its
// own. After kMaxAbandoned of them open() refuses.
//
// A frame that lay there when wait() was called, the camera having run out of buffers since, may be
// old. wait() then waits for a fresh one as long as its timeout allows.

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/request.h>

#include "drivers/camera/camera.h"
#include "drivers/camera/frame_sequence.h"
#include "drivers/camera/frame_stamps.h"
#include "drivers/camera/libcamera_buffers.h"
#include "drivers/camera/libcamera_mode.h"
#include "drivers/camera/sensor_clock.h"
#include "drivers/camera/v4l2_settings.h"
#include "platform/linux/spsc_queue.h"
#include "platform/linux/thread.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class LibcameraCamera final : public Camera {
 public:
  explicit LibcameraCamera(const V4l2Settings& settings) : settings_(settings) {}
  ~LibcameraCamera() override { close(); }

  Status open() override;
  void close() override;
  CameraWait wait(Duration timeout, CameraFrame& out) override;

  std::string description() const override { return description_; }
  Duration period() const override { return agreed_period_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  const char* lost_reason() const override { return lost_reason_ != nullptr ? lost_reason_ : ""; }
  const CameraCounters& counters() const override { return counters_; }

 private:
  static constexpr std::size_t kQueued = 64;  // more than buffers
  static constexpr std::uint64_t kMaxAbandoned = 16;

  // A finished request, as libcamera's thread saw it.
  struct Finished {
    std::uint32_t index = 0;  // of the request and its buffer
    std::uint32_t sequence = 0;
    std::uint64_t bytes = 0;
    Time stamp;
    bool good = false;
  };

  Status start();
  Status agree();
  Status make_requests();
  Status start_stream();
  void end_stream();
  void abandon_stream();
  // Of libcamera's thread.
  void finished(libcamera::Request* request);
  void disconnected();
  // Of our own.
  void give_back_requests();
  // Of the caller of wait().
  void give_back(std::uint32_t index);
  void give_back_held();
  void drain();
  bool is_stale(Time now) const;
  CameraWait deliver(Time now, CameraFrame& out);
  bool check_alive(Time now);

  V4l2Settings settings_;
  std::unique_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  LibcameraMode mode_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  LibcameraBuffers buffers_;
  std::size_t stride_ = 0;
  std::size_t needed_bytes_ = 0;
  std::vector<std::uint8_t> copy_;  // of one frame, when it cannot be used in place
  std::string description_;
  std::vector<std::string> warnings_;

  UniqueFd finished_event_;
  UniqueFd returned_event_;
  SpscQueue<Finished, kQueued> finished_;
  SpscQueue<std::uint32_t, kQueued> returned_;
  Thread giver_;
  std::atomic<bool> stop_ = false;
  std::atomic<const char*> failure_ = nullptr;  // a static text, once something is wrong
  std::atomic<bool> disconnected_ = false;
  bool streaming_ = false;

  CameraCounters counters_;
  FrameStamps stamps_;
  SensorClock clock_;
  FrameSequence sequence_;
  const char* lost_reason_ = "the camera is not open";
  Duration agreed_period_;  // 0: the rate is not in our hands
  Duration period_;         // else the wished one
  Duration stall_;
  Duration patience_;  // until the next good frame: longer before the first
  Time last_alive_;
  bool holds_ = false;
  Finished held_;
  std::uint64_t held_number_ = 0;
  std::size_t taken_at_once_ = 0;
};

}  // namespace zenith
