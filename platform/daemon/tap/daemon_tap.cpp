#include "platform/daemon/tap/daemon_tap.h"

#include "drivers/odometry/dbc.h"
#include "platform/daemon/version.h"
#include "platform/linux/input_file.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/log.h"

namespace zenith::tap {

Hello describe_robot(const DaemonConfig& config, const Devices& devices) {
  Hello hello;
  hello.robot = config.name;
  hello.software = std::string("zenithd ") + kVersion;
  hello.devices = devices.description;
  hello.config = devices.robot;
  hello.odometry = devices.odometry.value_or(config.odometry);
  hello.can_interface = config.can_interface;
  if (hello.odometry.kind == WheelCodecKind::kDbc) {
    auto content = read_input(hello.odometry.dbc.file, kMaxDbcBytes);
    if (content) hello.dbc = std::move(*content);
  }
  return hello;
}

DaemonTap make_daemon_tap(const DaemonConfig& config, const Devices& devices) {
  DaemonTap made;
  if (!config.record.enabled) return made;
  const Lens& lens = devices.robot.lens;
  made.tap = std::make_unique<Tap>(lens.width_px, lens.height_px, config.record.frames);
  made.server = std::make_unique<TapServer>(*made.tap, describe_robot(config, devices));
  const auto path = runtime_path(config.record.socket);
  const Status opened = path ? made.server->open(*path) : Status(path.error());
  if (opened) {
    log_line(LogLevel::kInfo, "record: %s", made.server->path().c_str());
  } else {
    log_line(LogLevel::kWarning, "%s; nobody can record", opened.error().message.c_str());
  }
  return made;
}

}  // namespace zenith::tap
