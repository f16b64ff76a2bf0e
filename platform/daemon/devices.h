#pragma once
// The devices of one robot behind their interfaces, made from the configuration. Nothing is opened
// yet: they may come late, and are opened again when they vanish (device_keeper.h).

#include <memory>
#include <optional>
#include <string>

#include "drivers/camera/camera.h"
#include "drivers/odometry/can_bus.h"
#include "drivers/odometry/wheel_decoder.h"
#include "platform/base/result.h"
#include "platform/daemon/config.h"
#include "slam/robot.h"

namespace zenith {

// What moves simulated devices: a world with threads of its own, which end with it.
class DeviceWorld {
 public:
  DeviceWorld() = default;
  DeviceWorld(const DeviceWorld&) = delete;
  DeviceWorld& operator=(const DeviceWorld&) = delete;
  virtual ~DeviceWorld() = default;
};

struct Devices {
  std::unique_ptr<Camera> camera;
  std::unique_ptr<CanBus> can;
  WheelDecoder decoder;
  // How the base speaks, when it is not as the configuration says: that of a recording.
  std::optional<WheelCodecConfig> odometry;
  RobotConfig robot;  // its lens is as large as the camera's frames
  std::string description;
  std::unique_ptr<DeviceWorld> world;  // none for real devices; ends before what it moves
};

// How a program makes the devices that a configuration names.
using MakeDevices = Result<Devices> (*)(const DaemonConfig& config);

// Those of the kernel. Simulated and replayed ones are an error here: zenithd is built without the
// simulator and without what reads recordings.
Result<Devices> make_real_devices(const DaemonConfig& config);

}  // namespace zenith
