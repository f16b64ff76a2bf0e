#include "platform/daemon/config.h"

#include <algorithm>
#include <charconv>
#include <numbers>
#include <utility>

#include "drivers/leds/led_output.h"
#include "platform/base/printable.h"
#include "platform/config/lens_settings.h"
#include "platform/config/robot_settings.h"
#include "platform/daemon/tap/tap.h"
#include "slam/exchange/interface.h"

namespace zenith {
namespace {

constexpr std::uint32_t kLeastRate = 700;  // bytes a second for each copy, see slam/exchange
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

void append(Settings& to, Settings more) {
  for (Setting& setting : more) to.push_back(std::move(setting));
}

Settings live(Settings settings) {
  for (Setting& setting : settings) setting.live = true;
  return settings;
}

Settings camera_settings(DaemonConfig& c) {
  return {
      {"camera.driver", "", 0, 0,
       "v4l2: a camera of the kernel; libcamera: one that needs an image signal processor; "
       "simulated: a made-up building, see [simulation]; replay: a recording, see [replay]",
       choice_of(c.camera_driver, {"v4l2", "libcamera", "simulated", "replay"})},
      {"camera.device", "", 0, 0,
       "v4l2: /dev/video0, /dev/v4l/by-id/..., \"name:PART of the card's name\" or \"bus:PART of "
       "the "
       "bus information\"; the last three find it again when its number has changed",
       &c.camera.device},
      {"camera.id", "", 0, 0, "libcamera: a part of the camera's model or id; empty: the only one",
       &c.camera_id},
      {"camera.rate_hz", "1/s", 0.1, 1000,
       "a wish: the slowest rate that the camera offers and that is not slower, else its fastest",
       &c.camera.rate_hz},
      {"camera.format", "", 0, 0, "auto, or a fourcc such as GREY, YUYV, NV12", &c.camera.format},
      {"camera.buffers", "", 2, 32, "frames that the driver may fill ahead", &c.camera.buffers},
      {"camera.copy", "", 0, 0,
       "copy each frame into ordinary memory: for drivers whose buffers are slow to read",
       &c.camera.copy},
      {"camera.stall_s", "s", 0.01, 3600, "no frame for so long: the stream is started anew",
       &c.camera.stall_s},
      {"camera.first_frame_s", "s", 0.01, 3600, "the same for the first frame after a start",
       &c.camera.first_frame_s},
      {"camera.exposure", "", 0, 0, "leave it as it is, automatic, or exposure_us",
       choice_of(c.camera.exposure, {"leave", "auto", "manual"})},
      {"camera.exposure_us", "us", 1, 1e6, "for exposure = \"manual\"; short ones blur less",
       &c.camera.exposure_us},
      {"camera.gain", "", -1, 1e6,
       "v4l2: in the driver's own units, switches automatic gain off; libcamera: times; -1: leave "
       "it",
       &c.camera_gain},
      {"camera.power_line", "", 0, 0, "v4l2: the lamps' frequency, against flicker",
       choice_of(c.camera.power_line, {"leave", "off", "50Hz", "60Hz", "auto"})},
  };
}

Settings mount_settings(MountConfig& mount) {
  return {
      {"mount.x_m", "m", -10, 10, "forward of the middle between the wheels", &mount.x_m},
      {"mount.y_m", "m", -10, 10, "to the left of it", &mount.y_m},
      {"mount.z_m", "m", -1, 10, "above the floor", &mount.z_m},
      {"mount.roll_deg", "deg", -60, 60, "lean to the side", &mount.roll_deg},
      {"mount.pitch_deg", "deg", -60, 60, "lean forward", &mount.pitch_deg},
      {"mount.yaw_deg", "deg", -180, 180, "turn of the image: 0 when its columns point forward",
       &mount.yaw_deg},
  };
}

Settings device_settings(DaemonConfig& c) {
  Settings settings = {
      {"odometry.driver", "", 0, 0,
       "socketcan: an interface of the kernel; simulated and replay: as the camera",
       choice_of(c.odometry_driver, {"socketcan", "simulated", "replay"})},
      {"odometry.can_interface", "", 0, 0, "brought up by the system, not by zenithd",
       &c.can_interface},
  };
  Setting patience = {"odometry.patience_s",
                      "s",
                      0.0,
                      1.0,
                      "a frame waits so long for the wheels' travel at its moment; then the travel "
                      "is extrapolated",
                      &c.odometry_patience_s};
  patience.live = true;
  settings.push_back(std::move(patience));
  append(settings, odometry_settings(c.odometry));
  return settings;
}

Settings machine_settings(DaemonConfig& c) {
  Settings settings = {
      {"realtime.priority", "", 0, 99, "SCHED_FIFO of the perception thread; 0: none",
       &c.realtime.priority},
      {"realtime.cpus", "", 0, 0, "CPUs of the perception thread, such as \"2-3\"; empty: any",
       &c.realtime.cpus},
      {"realtime.lock_memory", "", 0, 0, "keep all memory in RAM", &c.realtime.lock_memory},
      {"realtime.hold_cpu_awake", "", 0, 0,
       "no deep sleep of the CPUs, from which they wake late; costs power",
       &c.realtime.hold_cpu_awake},
  };
  append(settings,
         live({
             {"load.busy_share", "", 0.1, 1.0,
              "a step that takes more of a frame's period than this sheds corners",
              &c.load.busy_share},
             {"load.corners_min", "", 8, 128, "fewer are never taken", &c.load.corners_min},
         }));
  append(settings,
         {
             {"telemetry.enabled", "", 0, 0, "whether there is a socket", &c.telemetry.enabled},
             {"telemetry.socket", "", 0, 0,
              "its path; a relative one lies in the service's runtime folder", &c.telemetry.socket},
         });
  append(settings, live({
                       {"telemetry.rate_hz", "1/s", 0.1, 100, "pose lines a second, at most",
                        &c.telemetry.rate_hz},
                   }));
  append(settings,
         {
             {"record.enabled", "", 0, 0,
              "whether `zenith record` may record the running robot: its frames, CAN frames and "
              "poses, through a socket for the service's own user and root",
              &c.record.enabled},
             {"record.socket", "", 0, 0,
              "its path; a relative one lies in the service's runtime folder", &c.record.socket},
             {"record.frames", "", 1, tap::Tap::kMaxFrames,
              "that may wait for a slow recorder, then frames are left out of the recording; the "
              "memory is taken at the start: 0.3 MB each at 640x480",
              &c.record.frames},
         });
  return settings;
}

Settings radio_settings(RadioConfig& radio) {
  return {
      {"radio.enabled", "", 0, 0, "whether maps are exchanged with other robots", &radio.enabled},
      {"radio.key_file", "", 0, 0,
       "the key that all robots of a fleet share, made by `zenith key new FILE`; a relative path "
       "starts at this file's folder; empty: no radio, the robot maps alone",
       &radio.key_file},
      {"radio.group", "", 0, 0,
       "multicast group, such as \"239.255.90.78\" or, for IPv6, \"ff02::5a4e\"; empty: none, "
       "peers are listed",
       &radio.udp.group},
      {"radio.port", "", 1, 65535, "of the group; the same for all robots", &radio.udp.port},
      {"radio.own_port", "", 0, 65535,
       "where this robot is reached alone; 0: any that is free, for several robots on one computer",
       &radio.udp.own_port},
      {"radio.interface", "", 0, 0,
       "network interface for the group, such as \"wlan0\"; empty: all that are up",
       &radio.udp.interface},
      {"radio.peers", "", 0, 0,
       "addresses that are told everything, besides the group or without one: "
       "\"192.168.1.7:21474, [fe80::1%wlan0]:21474\"; each robot lists the others",
       &radio.udp.peers},
      {"radio.max_rate", "byte/s", 5000, exchange::kMaxRate,
       "what this robot sends at most, all headers included", &radio.max_rate},
      {"radio.news_rate", "byte/s", 1000, exchange::kMaxRate,
       "of this, for changes of landmarks that peers know", &radio.news_rate},
      {"radio.forget_after_s", "s", 15, 86400,
       "a robot silent for so long counts as gone until it is heard again; its map stays",
       &radio.forget_after_s},
  };
}

Settings map_settings(MapConfig& map) {
  return {
      {"map.folder", "", 0, 0,
       "where the map is kept across restarts; a relative one lies in the service's state folder "
       "(STATE_DIRECTORY), and without a state folder no map is kept; empty: no map is kept",
       &map.folder},
      {"map.interval_s", "s", 1, 3600,
       "a map with new landmarks is written so often at most; when landmarks only became better "
       "known it waits twelve times as long",
       &map.interval_s},
  };
}

Settings led_settings(LedSettings& leds) {
  Settings settings;
  constexpr const char* kNames[kLedCount] = {"status", "peer", "fault"};
  constexpr const char* kTexts[kLedCount] = {
      "shows every state; gpio:NAME, gpiochip-label:LABEL:OFFSET, gpiochip:/dev/gpiochipN:OFFSET, "
      "led:NAME, or empty: none",
      "shows that maps are merged", "shows that something is missing or wrong"};
  for (std::size_t i = 0; i < leds.leds.size(); ++i) {
    const std::string key = std::string("leds.") + kNames[i];
    settings.push_back({key, "", 0, 0, kTexts[i], &leds.leds[i].name});
    settings.push_back(
        {key + "_active_low", "", 0, 0, "lit when the GPIO line is low", &leds.leds[i].active_low});
  }
  return live(std::move(settings));
}

Settings algorithm_settings(Parameters& parameters) {
  Settings settings = slam_settings(parameters);
  for (Setting& setting : settings) {
    if (setting.key == "slam.corners_max") setting.live = true;
  }
  return settings;
}

Settings simulation_settings(SimulationConfig& simulation) {
  return {
      {"simulation.world", "", 0, 0, "a name of docs/worlds.md, or a file", &simulation.world},
      {"simulation.robot", "", 0, 0, "one of the world's; empty: its first", &simulation.robot},
      {"simulation.seed", "", 0, 1e15, "decides looks, errors and noise", &simulation.seed},
      {"simulation.frame_rate_hz", "1/s", 0, 60, "of the camera; 0: the world's",
       &simulation.frame_rate_hz},
  };
}

Settings replay_settings(ReplayConfig& replay) {
  return {
      {"replay.folder", "", 0, 0, "of the recording; a relative one begins at this file's folder",
       &replay.folder},
      {"replay.speed", "", 0.1, 10,
       "1: as recorded; other speeds need a base that reports positions", &replay.speed},
      {"replay.loop", "", 0, 0,
       "at the end begin anew, for endurance tests: the robot does not know that it was carried "
       "back; else it stands",
       &replay.loop},
  };
}

// --- relations between keys ----------------------------------------------------------------------

void check_devices(const DaemonConfig& c, const KeyLines& lines, Problems& problems) {
  const auto check_pair = [&](CameraDriver camera, OdometryDriver odometry, const char* name) {
    const bool camera_is = c.camera_driver == camera;
    if (camera_is == (c.odometry_driver == odometry)) return;
    problems.add(lines.of(camera_is ? "camera.driver" : "odometry.driver"),
                 std::string("camera.driver and odometry.driver: either both are \"") + name +
                     "\" or neither: one robot has one world");
  };
  check_pair(CameraDriver::kSimulated, OdometryDriver::kSimulated, "simulated");
  check_pair(CameraDriver::kReplay, OdometryDriver::kReplay, "replay");
  if (c.camera_driver == CameraDriver::kReplay && c.replay.folder.empty()) {
    problems.add(lines.of("camera.driver"),
                 "camera.driver = \"replay\" needs replay.folder, the folder of a recording");
  }
  const int codec = lines.of("odometry.codec");
  if (c.odometry_driver == OdometryDriver::kSimulated &&
      c.odometry.kind != WheelCodecKind::kAgilexV2) {
    problems.add(codec, "odometry.codec: simulated robots speak agilex_v2");
  }
  if (!is_interface_name(c.can_interface)) {
    problems.add(lines.of("odometry.can_interface"),
                 "odometry.can_interface '" + c.can_interface + "' is no interface's name");
  }
  if (const auto decoder = make_wheel_decoder(c.odometry); !decoder) {
    problems.add(codec, decoder.error().message);
  }
  if (const auto leds = make_led_output(c.leds); !leds) {
    problems.add(lines.of("leds.status"), "leds: " + leds.error().message);
  }
}

void check_relations(const DaemonConfig& c, const KeyLines& lines, Problems& problems) {
  const auto check = [&](bool good, const char* key, const std::string& what) {
    if (!good) problems.add(lines.of(key), key + what);
  };
  for (const LensProblem& problem : lens_problems(c.lens)) {
    const std::string key = "lens." + problem.key;
    problems.add(lines.of(key), key + problem.what);
  }
  check(c.slam.min_height_m < c.slam.max_height_m, "slam.min_height_m",
        " is not below slam.max_height_m");
  check(c.load.corners_min <= c.slam.corners_max, "load.corners_min", " is above slam.corners_max");
  const auto cpus = parse_cpus(c.realtime.cpus);
  check(cpus.ok(), "realtime.cpus", cpus ? "" : ": " + cpus.error().message);
  check(!c.telemetry.enabled || !c.telemetry.socket.empty(), "telemetry.socket",
        " is empty; telemetry.enabled = false switches it off");
  check(!c.record.enabled || !c.record.socket.empty(), "record.socket",
        " is empty; record.enabled = false switches it off");
  check(is_robot_name(c.name), "robot.name",
        " '" + c.name + "' is no name: expected 1 to 32 bytes of UTF-8 without control characters");
  if (c.radio.enabled && !c.radio.key_file.empty()) {
    const Status good = zenith::check(c.radio.udp);
    check(good.ok(), "radio.group", good ? "" : " and radio.peers: " + good.error().message);
  }
  const std::size_t copies = (c.radio.udp.group.empty() ? 0u : 1u) +
                             static_cast<std::size_t>(std::count(c.radio.udp.peers.begin(),
                                                                 c.radio.udp.peers.end(), ',')) +
                             (c.radio.udp.peers.empty() ? 0u : 1u);
  check(c.radio.max_rate >= kLeastRate * copies, "radio.max_rate",
        " is too little: each of " + std::to_string(copies) +
            " copies of what goes to everybody needs 700 bytes a second");
  check(c.radio.news_rate <= c.radio.max_rate, "radio.news_rate", " is above radio.max_rate");
}

// "7" of "7,9-11"; false when there is none below 64.
bool take_cpu(const char*& at, const char* end, unsigned& cpu) {
  const auto [stop, status] = std::from_chars(at, end, cpu);
  at = stop;
  return status == std::errc() && cpu < 64;
}

}  // namespace

RobotConfig DaemonConfig::robot() const {
  RobotConfig config;
  config.lens = lens;
  config.mount = {mount.x_m,
                  mount.y_m,
                  mount.z_m,
                  mount.roll_deg * kRadPerDeg,
                  mount.pitch_deg * kRadPerDeg,
                  mount.yaw_deg * kRadPerDeg};
  config.wheels = wheels;
  config.frame_rate_hz = camera.rate_hz;
  return config;
}

V4l2Settings DaemonConfig::v4l2() const {
  V4l2Settings settings = camera;
  settings.width = lens.width_px;
  settings.height = lens.height_px;
  if (camera_gain >= 0) settings.gain = camera_gain;
  return settings;
}

V4l2Settings DaemonConfig::libcamera() const {
  V4l2Settings settings = v4l2();
  settings.device = camera_id;
  return settings;
}

Settings daemon_settings(DaemonConfig& c) {
  Settings settings = {
      {"robot.name", "", 0, 0, "how others call this robot", &c.name},
      {"robot.seed", "", 0, 1e15, "of the filter's random numbers", &c.seed},
  };
  append(settings, camera_settings(c));
  append(settings, lens_settings(c.lens));
  append(settings, mount_settings(c.mount));
  append(settings, wheel_settings(c.wheels));
  append(settings, device_settings(c));
  append(settings, machine_settings(c));
  append(settings, radio_settings(c.radio));
  append(settings, map_settings(c.map));
  append(settings, led_settings(c.leds));
  append(settings, live({{"log.level", "", 0, 0, "less important lines are left out",
                          choice_of(c.log, {"error", "warning", "notice", "info", "debug"})}}));
  append(settings, algorithm_settings(c.slam));
  append(settings, simulation_settings(c.simulation));
  append(settings, replay_settings(c.replay));
  return settings;
}

Result<DaemonConfig> read_daemon_config(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) {
    return Error{file.string() +
                 ": missing, or no file; `zenithd --print-config` prints one to start from"};
  }
  DaemonConfig config;
  Problems problems(file);
  const KeyLines lines = read_settings(file, daemon_settings(config), problems);
  std::string& dbc = config.odometry.dbc.file;
  if (!dbc.empty()) dbc = (file.parent_path() / dbc).string();
  std::string& folder = config.replay.folder;
  if (!folder.empty()) folder = (file.parent_path() / folder).string();
  std::string& key = config.radio.key_file;
  if (!key.empty()) key = (file.parent_path() / key).string();
  // What a value out of its range brings about elsewhere would only hide it.
  if (!problems.any()) {
    check_devices(config, lines, problems);
    check_relations(config, lines, problems);
  }
  if (problems.any()) return problems.error();
  return config;
}

Result<std::uint64_t> parse_cpus(const std::string& text) {
  std::uint64_t cpus = 0;
  const char* at = text.data();
  const char* end = at + text.size();
  const Error wrong = {"expected CPUs below 64 such as \"2\", \"2-3\" or \"0,2-3\", found \"" +
                       text + "\""};
  while (at != end) {
    unsigned first = 0;
    if (!take_cpu(at, end, first)) return wrong;
    unsigned last = first;
    if (at != end && *at == '-' && !take_cpu(++at, end, last)) return wrong;
    if (last < first) return wrong;
    for (unsigned cpu = first; cpu <= last; ++cpu) cpus |= std::uint64_t{1} << cpu;
    if (at == end) break;
    if (*at != ',' || ++at == end) return wrong;
  }
  return cpus;
}

std::vector<std::string> changed_keys(const DaemonConfig& before, const DaemonConfig& after,
                                      bool live_ones) {
  DaemonConfig a = before;
  DaemonConfig b = after;
  const Settings old_settings = daemon_settings(a);
  const Settings new_settings = daemon_settings(b);
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < old_settings.size(); ++i) {
    if (old_settings[i].live != live_ones) continue;
    if (toml_value(old_settings[i]) != toml_value(new_settings[i])) {
      keys.push_back(old_settings[i].key);
    }
  }
  return keys;
}

void take_live(const DaemonConfig& from, DaemonConfig& to) {
  to.odometry_patience_s = from.odometry_patience_s;
  to.load = from.load;
  to.telemetry.rate_hz = from.telemetry.rate_hz;
  to.leds = from.leds;
  to.log = from.log;
  to.slam.corners_max = from.slam.corners_max;
}

}  // namespace zenith
