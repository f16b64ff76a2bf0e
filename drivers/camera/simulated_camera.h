#pragma once
// A camera in memory: the thread of a simulated robot or of a recording delivers frames, the
// perception thread waits for them in the kernel, as it would for a real camera's.
//
// Frames lie in kBuffers buffers, as in a driver; when none is free a frame is lost, and its number
// with it.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/camera/camera.h"
#include "platform/linux/spsc_queue.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class SimulatedCamera final : public Camera {
 public:
  static constexpr int kBuffers = 4;

  // `on_open` runs in each open(): the world may begin to turn with the first.
  SimulatedCamera(int width_px, int height_px, std::string description,
                  std::function<void()> on_open);

  // The sender's side, one thread. Waits for nobody.
  void deliver(Time stamp, std::span<const std::uint8_t> pixels);
  // A frame that cannot be used: it is counted, and its number is used up.
  void deliver_damaged();
  // What open() agrees on from then on; 0: it does not say. Any thread.
  void set_period(Duration period) { offered_ns_.store(period.ns, std::memory_order_relaxed); }
  // False: pulled out; open() fails until it is plugged in again. Any one thread.
  void set_plugged(bool plugged) { plugged_.store(plugged, std::memory_order_release); }

  Status open() override;
  void close() override;
  CameraWait wait(Duration timeout, CameraFrame& out) override;

  std::string description() const override { return description_; }
  Duration period() const override { return period_; }
  const char* lost_reason() const override { return lost_reason_; }
  const CameraCounters& counters() const override { return counters_; }

 private:
  static constexpr int kDamaged = -1;  // instead of a buffer

  struct Filled {
    int buffer = kDamaged;
    Time stamp;
    std::uint64_t number = 0;
  };

  void give_back(const Filled& frame);
  void give_back_held();
  bool take_newest();

  const int width_px_;
  const int height_px_;
  const std::string description_;
  const std::function<void()> on_open_;
  UniqueFd event_;
  std::array<std::vector<std::uint8_t>, kBuffers> buffers_;
  SpscQueue<Filled, 8> filled_;
  SpscQueue<int, 8> free_;
  std::atomic<bool> streaming_ = false;
  std::atomic<bool> plugged_ = true;
  std::atomic<std::int64_t> offered_ns_ = 0;

  std::uint64_t sent_ = 0;  // of the sender

  // Of the receiver.
  const char* lost_reason_ = "the camera is not open";
  Duration period_ = {0};
  bool holds_ = false;
  Filled held_;
  std::uint64_t first_number_ = 0;
  std::uint64_t next_number_ = 0;
  bool counting_ = false;  // a frame came since open()
  CameraCounters counters_;
};

}  // namespace zenith
