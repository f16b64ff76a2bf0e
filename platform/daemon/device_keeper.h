#pragma once
// Opens the devices, and again when they are lost, on a thread of its own: opening takes as long as
// it takes. A device that cannot be opened is tried again forever; its error is logged when it
// changes, and once a minute.

#include <atomic>
#include <string>

#include "drivers/camera/camera.h"
#include "drivers/odometry/can_bus.h"
#include "platform/base/time.h"
#include "platform/daemon/turn.h"

namespace zenith {

// One device's tries.
class Reopener {
 public:
  static constexpr Duration kRetry = {500'000'000};
  static constexpr Duration kRepeat = {60'000'000'000};

  explicit Reopener(const char* what) : what_(what) {}

  bool due(Time now) const { return now >= next_try_; }
  // Logs what is new, and says when to try again.
  void note(const Status& opened, Time now);
  bool failing() const { return !last_error_.empty(); }

 private:
  const char* what_;  // "camera"
  Time next_try_;
  Time told_;
  std::string last_error_;
};

class DeviceKeeper {
 public:
  DeviceKeeper(Camera& camera, Turn& camera_turn, CanBus& can, Turn& can_turn)
      : camera_(camera), camera_turn_(camera_turn), can_(can), can_turn_(can_turn) {}

  // The thread's body. Ends soon after `stop`, but not before an open() that is under way.
  void run(const std::atomic<bool>& stop);
  // One look at both devices.
  void tend(Time now);

 private:
  void tend_camera(Time now);
  void tend_can(Time now);

  Camera& camera_;
  Turn& camera_turn_;
  CanBus& can_;
  Turn& can_turn_;
  Reopener camera_tries_{"camera"};
  Reopener can_tries_{"CAN bus"};
};

}  // namespace zenith
