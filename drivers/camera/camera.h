#pragma once
// Every camera, real, simulated or replayed, as the perception thread sees it.
//
// Two kinds of calls: open() and close() may allocate, take long and talk to the kernel at length;
// they belong to a thread without deadlines. wait() is for the realtime thread: no heap, no lock,
// no log, at most `timeout`. One caller at a time; who may call is handed over by the owner.

#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/image/image.h"

namespace zenith {

// One 8-bit grey fisheye frame. `luma` may view the driver's own buffer: it is valid until the next
// wait() or close().
struct CameraFrame {
  Time stamp;  // capture, CLOCK_MONOTONIC
  ImageView luma;
  // Number of this frame since open(), 0 the first. Frames that were skipped, damaged or lost in
  // the driver have numbers too, so a gap says how many the caller did not see.
  std::uint64_t sequence = 0;
};

enum class CameraWait {
  kFrame,    // `out` holds the newest frame; older ones were passed over and counted
  kTimeout,  // none yet
  kLost,     // unplugged, or the stream failed: close() and open() again; wait() says kLost until
};

struct CameraCounters {
  std::uint64_t frames = 0;           // delivered by wait()
  std::uint64_t skipped = 0;          // passed over because a newer one was there
  std::uint64_t lost_in_driver = 0;   // gaps in the driver's own sequence numbers
  std::uint64_t damaged = 0;          // marked bad by the driver, or too short: never delivered
  std::uint64_t stamps_replaced = 0;  // implausible or not monotonic stamps, replaced by "now"
  std::uint64_t opened = 0;
  std::uint64_t lost = 0;     // times that wait() found the stream gone
  std::uint64_t stalled = 0;  // of these: no error, but no frame either
  // Streams that could neither be stopped nor destroyed because their device was gone, and whose
  // memory and descriptors stay taken (libcamera).
  std::uint64_t abandoned = 0;
};

class Camera {
 public:
  Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;
  virtual ~Camera() = default;

  // Opens the device and starts the stream. The error names what was asked for, what the device
  // offers and what to do. Closes first when it is open already.
  virtual Status open() = 0;
  virtual void close() = 0;

  // Stamps rise strictly from frame to frame, also over a close() and open(). A timeout of zero or
  // less does not wait.
  virtual CameraWait wait(Duration timeout, CameraFrame& out) = 0;

  // After open(): what was agreed on, for a person: "V4L2 /dev/video0 (vivid), GREY 640x480, 25/s".
  virtual std::string description() const = 0;
  // After open(): the frames' period that the driver agreed on with the device; 0: it does not say.
  // Also for the realtime thread.
  virtual Duration period() const = 0;
  // After open(): what was asked for and could not be had, one sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }
  // Why wait() says kLost, a static text for the log; empty while it does not.
  virtual const char* lost_reason() const { return ""; }
  virtual const CameraCounters& counters() const = 0;
};

}  // namespace zenith
