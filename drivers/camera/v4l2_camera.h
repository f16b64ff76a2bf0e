#pragma once
// A camera behind V4L2: UVC webcams, mono sensors with a video node, v4l2loopback, vivid.
//
// Grey, NV12 and YUV 4:2:0 frames are used where the driver put them; YUYV and its like cost one
// copy (luma_format.h); compressed ones are refused. Stamps: frame_stamps.h.
//
// A frame that already lay there when wait() was called, the driver having run out of buffers
// since, may be old. wait() then waits for a fresh one as long as its timeout allows.

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/frame_sequence.h"
#include "drivers/camera/frame_stamps.h"
#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_format.h"
#include "drivers/camera/v4l2_io.h"
#include "drivers/camera/v4l2_settings.h"
#include "drivers/camera/v4l2_stream.h"

namespace zenith {

class V4l2Camera final : public Camera {
 public:
  // `io` must outlive the camera.
  explicit V4l2Camera(const V4l2Settings& settings, V4l2Io& io = kernel_v4l2_io());
  ~V4l2Camera() override { close(); }

  // Looks for the device anew each time, so it may have moved. Settings out of range are errors.
  Status open() override;
  void close() override;
  CameraWait wait(Duration timeout, CameraFrame& out) override;

  std::string description() const override { return description_; }
  Duration period() const override {
    return agreed_.rate_hz > 0.0 ? Duration::from_seconds(1.0 / agreed_.rate_hz) : Duration{0};
  }
  std::vector<std::string> warnings() const override { return warnings_; }
  const char* lost_reason() const override { return lost_reason_ != nullptr ? lost_reason_ : ""; }
  const CameraCounters& counters() const override { return counters_; }

 private:
  Status start();
  bool give_back_held();
  bool drain();
  bool is_stale(Time now) const;
  CameraWait deliver(Time now, CameraFrame& out);
  bool poll_until(Time deadline, Time now);
  void lose(const char* reason);

  V4l2Settings settings_;
  V4l2Io& io_;
  V4l2Device device_;
  V4l2Stream stream_;
  V4l2Agreed agreed_;
  std::vector<std::uint8_t> copy_;  // of one frame, when it cannot be used in place
  std::string description_;
  std::vector<std::string> warnings_;

  CameraCounters counters_;
  FrameStamps stamps_;
  FrameSequence sequence_;
  const char* lost_reason_ = "the camera is not open";
  Duration period_;
  Duration stall_;
  Duration patience_;  // until the next good frame: longer before the first
  Time last_alive_;
  bool begun_ = false;  // the stream's first frame has passed
  bool holds_ = false;  // held_ was taken from the driver
  V4l2Taken held_;
  std::uint64_t held_number_ = 0;
  std::size_t taken_at_once_ = 0;
};

}  // namespace zenith
