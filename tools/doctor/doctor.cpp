#include "tools/doctor/doctor.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "drivers/camera/v4l2_io.h"
#include "drivers/odometry/socket_can.h"
#include "drivers/radio/interfaces.h"
#include "platform/daemon/devices.h"
#include "platform/daemon/map_keeper.h"
#include "tools/doctor/check_camera.h"
#include "tools/doctor/check_can.h"
#include "tools/doctor/check_config.h"
#include "tools/doctor/check_daemon.h"
#include "tools/doctor/check_fleet.h"
#include "tools/doctor/check_leds.h"
#include "tools/doctor/check_machine.h"

namespace zenith::tools {
namespace {

constexpr Duration kDaemonPatience = {3'000'000'000};

// Findings as they come.
class Telling {
 public:
  explicit Telling(const std::function<void(const Finding&)>& tell) : tell_(tell) {}
  void add(Finding finding) {
    tell_(finding);
    all_.push_back(std::move(finding));
  }
  void add(Findings findings) {
    for (Finding& finding : findings) add(std::move(finding));
  }
  Findings take() { return std::move(all_); }

 private:
  const std::function<void(const Finding&)>& tell_;
  Findings all_;
};

// Its stream, by the driver that the daemon would use.
void check_stream(const DaemonConfig& config, double watch_s, Telling& telling) {
  const auto devices = make_real_devices(config);
  if (!devices) return telling.add(fail("camera device", devices.error().message, ""));
  std::optional<PictureFacts> picture;
  const StreamFacts facts =
      watch_camera(*devices->camera, Duration::from_seconds(watch_s), picture);
  telling.add(check_camera_rate(facts, config.camera.rate_hz));
  telling.add(check_camera_stamps(facts));
  if (picture) telling.add(check_picture(*picture));
}

void check_camera(const DaemonConfig& config, const MachineFiles& files, const DaemonFacts& daemon,
                  double watch_s, Telling& telling) {
  const bool is_v4l2 = config.camera_driver == CameraDriver::kV4l2;
  if (!is_v4l2 && config.camera_driver != CameraDriver::kLibcamera) {
    return telling.add(skip("camera", "camera.driver says that it is made up"));
  }
  if (is_v4l2) {
    std::string path;
    telling.add(check_camera_device(config.v4l2(), kernel_v4l2_io(), path));
    if (path.empty()) return;
    telling.add(check_camera_free(users_of(files, path), daemon.pid));
  }
  if (daemon.running) {
    return telling.add(skip("camera rate", "zenithd has the camera; see the lines about it"));
  }
  check_stream(config, watch_s, telling);
}

void check_can(const DaemonConfig& config, const MachineFiles& files, double watch_s,
               Telling& telling) {
  if (config.odometry_driver != OdometryDriver::kSocketCan) {
    return telling.add(skip("can", "odometry.driver says that it is made up"));
  }
  const std::string& name = config.can_interface;
  CanLink link = read_can_link(files, name);
  const std::string answer = ask_can_controller(name);
  link.controller =
      parse_can_controller({reinterpret_cast<const std::uint8_t*>(answer.data()), answer.size()});
  telling.add(check_can_interface(name, link, list_can_interfaces(files)));
  if (!link.is_can || !link.up) return;
  telling.add(check_can_controller(name, link));
  const auto decoder = make_wheel_decoder(config.odometry);
  if (!decoder) return telling.add(fail("wheels", decoder.error().message, "correct [odometry]"));
  SocketCanBus bus({name, {}});
  const TrafficFacts facts = listen_to(bus, *decoder, Duration::from_seconds(watch_s));
  telling.add(check_can_traffic(name, facts));
  const std::string codec(wheel_codec_name(config.odometry.kind));
  telling.add(check_wheels(facts, decoder->ids(), codec));
}

void check_lights(const DaemonConfig& config, const MachineFiles& files, Telling& telling) {
  std::string why_none;
  const auto chips = list_gpio_chips(&why_none);
  telling.add(check_leds(config.leds, chips, why_none, files));
}

void check_others(const RadioConfig& radio, const MachineFiles& files, const DaemonFacts& daemon,
                  Telling& telling) {
  telling.add(check_fleet_key(radio));
  if (!radio.enabled || radio.key_file.empty()) return;
  const std::string& group = radio.udp.group;
  const bool ipv6 = group.find(':') != std::string::npos;
  telling.add(check_network(usable_interfaces(radio.udp.interface, ipv6), radio.udp.interface));
  telling.add(check_group(group, joined_interfaces(files, group), daemon.running));
}

void check_computer(const DaemonConfig& config, const MachineFiles& files,
                    const DaemonFacts& daemon, const std::string& state_folder, Telling& telling) {
  LimitFacts limits = {realtime_limits(), "this shell (the unit sets the service's)",
                       ::geteuid() == 0};
  if (daemon.pid != 0) (void)read_process_limits(files, daemon.pid, limits);
  telling.add(check_fifo(config.realtime, limits));
  telling.add(check_locked_memory(config.realtime, limits));
  telling.add(check_cpu_dma_latency(config.realtime, files));
  telling.add(check_governor(files));
  telling.add(check_preemption(files));
  telling.add(check_rt_throttling(config.realtime, files));
  telling.add(check_clock_source(files));
  const ClockFacts clock = read_clock();
  telling.add(check_clock_sync(clock));
  telling.add(check_monotonic(clock));
  telling.add(check_temperature(files));
  telling.add(check_power(files));
  const std::string maps = map_folder(config.map.folder, state_folder);
  if (maps.empty()) {
    telling.add(skip("map folder", "map.folder is empty: no map is kept"));
  } else {
    telling.add(check_map_folder(maps, storage::look_at_folder(maps), config.name, daemon.pid));
  }
  const std::string& disk = maps.empty() ? state_folder : maps;
  telling.add(check_disk(disk, free_disk_mb(disk)));
}

}  // namespace

Findings run_doctor(const DoctorPlan& plan, const std::function<void(const Finding&)>& tell) {
  Telling telling(tell);
  const MachineFiles files;
  std::optional<DaemonConfig> read;
  telling.add(check_config(plan.config, read));
  if (!read) {
    telling.add(skip("devices", "the configuration is wrong: checked when it is right"));
    read = DaemonConfig();
    check_computer(*read, files, {}, plan.state_folder, telling);
    return telling.take();
  }
  const DaemonConfig& config = *read;
  const DaemonFacts daemon =
      config.telemetry.enabled ? ask_daemon(config, kDaemonPatience) : DaemonFacts();
  if (config.telemetry.enabled) {
    telling.add(check_daemon(daemon));
  } else {
    telling.add(skip("daemon", "telemetry.enabled = false: it cannot be asked"));
  }
  check_camera(config, files, daemon, plan.watch_s, telling);
  check_can(config, files, plan.watch_s, telling);
  check_lights(config, files, telling);
  check_others(config.radio, files, daemon, telling);
  check_computer(config, files, daemon, plan.state_folder, telling);
  return telling.take();
}

}  // namespace zenith::tools
