#pragma once
// What needs no deadline: the log, lights, telemetry, the service manager and its watchdog, reload.
// Called by the main thread, some twenty times a second.

#include <filesystem>
#include <memory>
#include <string>

#include "drivers/leds/led_output.h"
#include "platform/daemon/config.h"
#include "platform/daemon/cooperation.h"
#include "platform/daemon/health.h"
#include "platform/daemon/map_keeper.h"
#include "platform/daemon/perception.h"
#include "platform/daemon/telemetry_socket.h"
#include "platform/linux/service_notify.h"

namespace zenith {

LiveSettings live_settings(const DaemonConfig& config);

class Housekeeping {
 public:
  // All must outlive it. `file` is read again by reload().
  Housekeeping(DaemonConfig config, std::filesystem::path file, const std::string& devices,
               Perception& perception, Cooperation& cooperation, Exchange& exchange,
               ServiceNotify& notify, const MapKeeper* map_keeper = nullptr);

  // Telemetry and lights. What does not work is logged; the daemon goes on.
  void start(Time now);
  void tick(Time now);
  // SIGHUP: the configuration and the fleet's key. Of either, a file that is wrong changes nothing.
  void reload(Time now);
  // Lights off, the account of the run into the log.
  void finish(Time now);

  // How often the watchdog was told; it stays when the perception thread does.
  std::uint64_t watchdog_fed() const { return watchdog_fed_; }
  const Health& health() const { return health_; }

 private:
  void log_events();
  void log_event(const PerceptionEvent& event) const;
  void note_wheels();
  void note_lately(Time now);
  void show_lights(Time now);
  void make_lights(const LedSettings& settings);
  void send_telemetry(Time now);
  void send_picture(Time now);
  void send_second(Time now);
  void feed_watchdog(Time now);
  void tell_status(Time now);
  void note_manager(const Status& told);
  void reload_keys();

  DaemonConfig config_;
  const std::filesystem::path file_;
  const std::string devices_;
  Perception& perception_;
  Cooperation& cooperation_;
  Exchange& exchange_;
  ServiceNotify& notify_;
  const MapKeeper* map_keeper_;  // null: no map is kept
  MapStatus stored_;

  TelemetrySocket telemetry_;
  std::unique_ptr<LedOutput> leds_;
  Time started_;
  PerceptionReport report_;
  LinkStatus link_;
  Health health_;
  WheelFaultKind wheel_fault_ = WheelFaultKind::kNone;  // as logged
  Lately lately_;
  Lately lately_before_;  // totals when lately_ began
  bool manager_deaf_ = false;

  std::uint64_t heartbeat_ = 0;
  std::uint64_t watchdog_fed_ = 0;
  std::string told_status_;
  Time light_changed_;
  Time next_lately_;
  Time next_leds_open_;
  Time next_pose_;
  Time next_health_;
  Time next_picture_;
  Time next_watchdog_;
  Time next_status_;
  Time pose_told_;
};

}  // namespace zenith
