#pragma once
// The tap: while somebody records, the perception thread leaves a copy of each frame here, and each
// CAN frame and pose, and another thread takes them out (tap_server.h).
//
// All memory is taken, and touched, when it is made. The perception thread's calls copy into a free
// slot; when none is free they count a drop and return. They never wait, lock or allocate, and cost
// one load while nobody records.

#include <atomic>
#include <cstdint>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/odometry/can_frame.h"
#include "platform/daemon/tap/wire.h"
#include "platform/linux/spsc_queue.h"

namespace zenith::tap {

struct Drops {
  std::uint64_t frames = 0;
  std::uint64_t can = 0;
  std::uint64_t poses = 0;
};

// A frame in its slot, until give_back().
struct TappedFrame {
  FrameHead head;
  const std::uint8_t* pixels = nullptr;  // width x height, without gaps
  int slot = 0;
};

class Tap {
 public:
  static constexpr int kMaxFrames = 64;

  // For frames of exactly this size; at most `frames` (1 .. kMaxFrames) wait for the reader.
  Tap(int width, int height, int frames);

  // --- the perception thread ----------------------------------------------------------------

  void add(const CameraFrame& frame);
  void add(const CanFrame& frame);
  void add(const TappedPose& pose);

  // --- the server's thread ------------------------------------------------------------------

  // What was left from before is not part of the new recording.
  void start();
  void stop();
  bool next(TappedFrame& out);
  void give_back(const TappedFrame& frame) { free_.push(frame.slot); }
  bool next(CanFrame& out);
  bool next(TappedPose& out);
  // Since start(), for want of room.
  Drops drops() const;

 private:
  struct FilledSlot {
    std::uint32_t session = 0;
    int slot = 0;
    FrameHead head;
  };
  struct MarkedCan {
    std::uint32_t session = 0;
    CanFrame frame;
  };
  struct MarkedPose {
    std::uint32_t session = 0;
    TappedPose pose;
  };

  Drops rejected() const;
  std::uint8_t* pixels_of(int slot) {
    return memory_.data() + static_cast<std::size_t>(slot) * frame_bytes_;
  }

  const int width_;
  const int height_;
  const std::size_t frame_bytes_;
  std::vector<std::uint8_t> memory_;
  SpscQueue<int, kMaxFrames> free_;           // server -> perception
  SpscQueue<FilledSlot, kMaxFrames> filled_;  // perception -> server
  SpscQueue<MarkedCan, 4096> can_;
  SpscQueue<MarkedPose, 256> poses_;
  std::atomic<std::uint32_t> session_ = 0;  // 0: nobody records
  std::atomic<std::uint64_t> frames_dropped_ = 0;

  std::uint32_t last_session_ = 0;  // of the server
  Drops before_;                    // of the server: when the session began
};

}  // namespace zenith::tap
