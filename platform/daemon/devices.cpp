#include "platform/daemon/devices.h"

#include "drivers/camera/libcamera_driver.h"
#include "drivers/camera/v4l2_camera.h"
#include "drivers/odometry/socket_can.h"

namespace zenith {

Result<Devices> make_real_devices(const DaemonConfig& config) {
  if (config.camera_driver == CameraDriver::kSimulated) {
    return Error{
        "camera.driver = \"simulated\": this program has real devices alone; zenithd-sim "
        "has simulated ones"};
  }
  if (config.camera_driver == CameraDriver::kReplay) {
    return Error{
        "camera.driver = \"replay\": this program has real devices alone and reads neither the PNG "
        "nor the YAML files of recordings; zenithd-sim plays them"};
  }
  auto decoder = make_wheel_decoder(config.odometry);
  if (!decoder) return decoder.error();
  Devices devices;
  devices.decoder = *decoder;
  devices.robot = config.robot();
  devices.can =
      std::make_unique<SocketCanBus>(SocketCanSettings{config.can_interface, decoder->ids()});
  std::string camera;
  if (config.camera_driver == CameraDriver::kLibcamera) {
    auto made = make_libcamera_camera(config.libcamera());
    if (!made) return Error{"camera.driver = \"libcamera\": " + made.error().message};
    devices.camera = std::move(*made);
    camera = "libcamera's camera " + config.camera_id;
  } else {
    devices.camera = std::make_unique<V4l2Camera>(config.v4l2());
    camera = "V4L2 camera " + config.camera.device;
  }
  devices.description = camera + ", CAN interface " + config.can_interface + ", codec " +
                        std::string(wheel_codec_name(config.odometry.kind));
  return devices;
}

}  // namespace zenith
