#pragma once
// What zenithd is told: plain data with defaults, and the one list of its keys, from which reading,
// checks, the annotated file config/zenith.toml and docs/configuration.md come (config_text.h).
// Ranges, units and texts stand in config.cpp alone.

#include <cstdint>
#include <filesystem>
#include <string>

#include "drivers/camera/v4l2_settings.h"
#include "drivers/leds/led_name.h"
#include "drivers/odometry/wheel_codec_config.h"
#include "drivers/radio/udp_radio.h"
#include "platform/base/result.h"
#include "platform/config/setting.h"
#include "platform/linux/log.h"
#include "slam/parameters.h"
#include "slam/robot.h"

namespace zenith {

enum class CameraDriver { kV4l2, kLibcamera, kSimulated, kReplay };
enum class OdometryDriver { kSocketCan, kSimulated, kReplay };
// In files: "error", "warning", "notice", "info", "debug".
enum class LogChoice { kError, kWarning, kNotice, kInfo, kDebug };

// Degrees, as people measure them.
struct MountConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.3;
  double roll_deg = 0.0;
  double pitch_deg = 0.0;
  double yaw_deg = 0.0;
};

struct RealtimeConfig {
  int priority = 50;           // SCHED_FIFO; 0: normal scheduling
  std::string cpus;            // "2", "2-3", "0,2"; empty: any
  bool lock_memory = true;     // mlockall
  bool hold_cpu_awake = true;  // /dev/cpu_dma_latency
};

struct LoadConfig {
  double busy_share = 0.8;  // of a frame's period; above it corners are shed
  int corners_min = 40;
};

struct TelemetryConfig {
  bool enabled = true;
  std::string socket = "telemetry.sock";  // relative: in runtime_folder()
  double rate_hz = 10.0;                  // of pose lines, at most
};

struct RecordConfig {
  bool enabled = true;
  std::string socket = "record.sock";  // relative: as telemetry.socket
  int frames = 16;                     // that wait for a recorder
};

struct RadioConfig {
  bool enabled = true;
  std::string key_file;  // empty: no radio
  RadioSettings udp;
  std::uint32_t max_rate = 125'000;  // bytes a second
  std::uint32_t news_rate = 20'000;
  double forget_after_s = 60.0;
};

struct MapConfig {
  std::string folder = ".";  // relative: in the state folder; empty: no map is kept
  double interval_s = 4.0;
};

struct SimulationConfig {
  std::string world = "corridor-rooms";
  std::string robot;           // by name; empty: the world's first
  std::uint64_t seed = 1;      // of the world, the errors and the noise
  double frame_rate_hz = 0.0;  // 0: the world's
};

struct ReplayConfig {
  std::string folder;  // of a recording
  double speed = 1.0;
  bool loop = false;
};

struct DaemonConfig {
  std::string name = "zenith";
  std::uint64_t seed = 1;  // of the filter's random numbers
  CameraDriver camera_driver = CameraDriver::kV4l2;
  V4l2Settings camera;    // width and height come from the lens
  int camera_gain = -1;   // -1: leave as it is
  std::string camera_id;  // of libcamera
  Lens lens;
  MountConfig mount;
  Wheels wheels;
  OdometryDriver odometry_driver = OdometryDriver::kSocketCan;
  std::string can_interface = "can0";
  double odometry_patience_s = 0.05;  // a frame waits so long for the wheels of its moment
  WheelCodecConfig odometry;
  RealtimeConfig realtime;
  LoadConfig load;
  TelemetryConfig telemetry;
  RecordConfig record;
  RadioConfig radio;
  MapConfig map;
  LedSettings leds;
  LogChoice log = LogChoice::kInfo;
  Parameters slam;
  SimulationConfig simulation;
  ReplayConfig replay;

  RobotConfig robot() const;
  V4l2Settings v4l2() const;
  V4l2Settings libcamera() const;
  LogLevel log_level() const { return static_cast<LogLevel>(static_cast<int>(log) + 3); }
};

// The list of keys over `config`, section by section. Keys that may change while the daemon runs
// are `live`.
Settings daemon_settings(DaemonConfig& config);

// Everything that is wrong at once, a line each. Relative odometry.dbc.file and
// replay.folder are taken from the folder of the file.
Result<DaemonConfig> read_daemon_config(const std::filesystem::path& file);

// "2", "2-3", "0,2-3" as bits of CPUs below 64; 0 for an empty text.
Result<std::uint64_t> parse_cpus(const std::string& text);

// The keys whose values differ, live ones or the others.
std::vector<std::string> changed_keys(const DaemonConfig& before, const DaemonConfig& after,
                                      bool live);

// Takes over the live values of `from`.
void take_live(const DaemonConfig& from, DaemonConfig& to);

}  // namespace zenith
