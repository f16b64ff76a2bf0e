#pragma once
// Plays what a robot's devices saw in real time: one thread prepares frames ahead, another sends
// CAN frames and frames at their moments. Both are outside of the perception thread, as devices
// are.
//
// The clock of what is played is CLOCK_MONOTONIC less an offset, one for frames and CAN. Where the
// computer prepares more slowly than frames are due the offset grows: all goes more slowly then,
// but wheels and camera agree. After the last moment the robot stands, and its devices go on.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/camera/simulated_camera.h"
#include "drivers/odometry/simulated_can.h"
#include "platform/daemon/devices.h"
#include "platform/linux/spsc_queue.h"
#include "platform/linux/thread.h"

namespace zenith {

enum class MomentFrame { kNone, kGood, kDamaged };

// A frame, and the CAN frames since the last one.
struct Moment {
  std::vector<CanFrame> can;  // stamps do not go back
  Time stamp;                 // of the frame; rises
  MomentFrame frame = MomentFrame::kNone;
  std::vector<std::uint8_t> pixels;

  Time begin() const { return can.empty() ? stamp : std::min(can.front().stamp, stamp); }
};

// What is played. The calls come from one thread, but standing() and ended() from another, after
// next() gave false.
class MomentSource {
 public:
  MomentSource() = default;
  MomentSource(const MomentSource&) = delete;
  MomentSource& operator=(const MomentSource&) = delete;
  virtual ~MomentSource() = default;

  // Fills all of `moment`, whose memory is used again; false at the end.
  virtual bool next(Moment& moment) = 0;
  virtual Duration frame_period() const = 0;
  // Frames that say that the wheels stand, whatever their stamps; none: the bus falls silent.
  virtual std::vector<CanFrame> standing() const = 0;
  // The last moment was played.
  virtual void ended() {}
};

class DevicePlayer final : public DeviceWorld {
 public:
  explicit DevicePlayer(std::unique_ptr<MomentSource> source);
  ~DevicePlayer() override;

  // Both must outlive it.
  void connect(SimulatedCamera& camera, SimulatedCanBus& can);
  // Plays from the first call on. Any one thread.
  void start();

 private:
  static constexpr std::size_t kAhead = 8;  // prepared moments that wait

  struct Slot {
    Moment moment;
    bool last = false;
  };

  void prepare();
  void play();
  bool wait_for_slot(std::size_t& slot);
  void follow_clock(Time begin, bool first);
  void play_moment(const Moment& moment);
  void stand();
  bool stopping() const { return stop_.load(std::memory_order_relaxed); }

  std::unique_ptr<MomentSource> source_;
  SimulatedCamera* camera_ = nullptr;
  SimulatedCanBus* can_ = nullptr;

  std::array<Slot, kAhead> slots_;
  SpscQueue<std::size_t, kAhead> free_;
  SpscQueue<std::size_t, kAhead> ready_;
  std::atomic<bool> stop_ = false;

  // Of the playing thread.
  Duration offset_;
  std::vector<std::uint8_t> last_pixels_;

  Thread preparing_;
  Thread playing_;
};

// The devices of a player that is made for them: a camera for this lens, a CAN bus for this
// decoder.
Devices make_played_devices(std::unique_ptr<MomentSource> source, const RobotConfig& robot,
                            const WheelDecoder& decoder, const std::string& description);

}  // namespace zenith
