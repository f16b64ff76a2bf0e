#include "platform/daemon/daemon.h"

#include <optional>
#include <string>

#include "platform/daemon/running_daemon.h"
#include "platform/daemon/version.h"
#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "platform/linux/service_notify.h"
#include "platform/linux/signals.h"

namespace zenith {
namespace {

constexpr Duration kTick = {50'000'000};

// The manager waits for READY: when the datagram finds no place, again.
void tell_ready(ServiceNotify& notify) {
  constexpr int kTries = 20;
  Status told = notify.ready();
  for (int i = 0; i < kTries && !told; ++i) {
    sleep_until(monotonic_now() + Duration{50'000'000});
    told = notify.ready();
  }
  if (!told) log_lines(LogLevel::kError, told.error().message);
}

// The main thread's work until the end. Returns the exit code.
int serve(RunningDaemon& daemon, ServiceNotify& notify, Signals& signals) {
  tell_ready(notify);
  log_line(LogLevel::kNotice, LogFields("ready"), "ready");
  while (true) {
    const auto request = signals.wait(kTick);
    if (request == SignalRequest::kStop) return 0;
    if (daemon.failed()) return 1;
    const Time now = monotonic_now();
    if (request == SignalRequest::kReload) daemon.housekeeping().reload(now);
    daemon.housekeeping().tick(now);
  }
}

// Where the map is kept; nothing, and said, when it is not.
std::optional<std::string> find_map_folder(const MapConfig& config) {
  const std::string state = state_folder();
  const std::string folder = map_folder(config.folder, state);
  if (folder.empty()) {
    log_line(LogLevel::kNotice, "no map is kept: %s",
             config.folder.empty() ? "map.folder is empty" : "there is no state folder");
    return std::nullopt;
  }
  if (const Status made = make_map_folder(config.folder, state); !made) {
    log_lines(LogLevel::kError, made.error().message);
  }
  return folder;
}

}  // namespace

int run_daemon(const DaemonConfig& config, const std::filesystem::path& file,
               MakeDevices make_devices, Signals& signals) {
  process_log().set_level(config.log_level());
  process_log().name_robot(config.name);
  log_line(LogLevel::kNotice, LogFields("started"), "zenithd %s: robot %s, configuration %s",
           kVersion, config.name.c_str(), file.c_str());
  ServiceNotify notify;
  if (const Status opened = notify.open_from_environment(); !opened) {
    log_lines(LogLevel::kWarning, opened.error().message);
  }
  auto devices = make_devices(config);
  if (!devices) {
    log_lines(LogLevel::kError, devices.error().message);
    process_log().drain(monotonic_now());
    return 1;
  }
  const auto folder = find_map_folder(config.map);
  storage::DiskFolder maps(folder.value_or(""));
  RunningDaemon daemon(config, file, *devices, notify, folder ? &maps : nullptr);
  return daemon.run([&] { return serve(daemon, notify, signals); });
}

}  // namespace zenith
