#include "platform/daemon/daemon.h"

#include <unistd.h>

#include <atomic>
#include <memory>
#include <string>

#include "platform/daemon/cooperation.h"
#include "platform/daemon/device_keeper.h"
#include "platform/daemon/housekeeping.h"
#include "platform/daemon/map_keeper.h"
#include "platform/daemon/memory_report.h"
#include "platform/daemon/perception.h"
#include "platform/daemon/radio_link.h"
#include "platform/daemon/tap/daemon_tap.h"
#include "platform/daemon/version.h"
#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "platform/linux/realtime.h"
#include "platform/linux/service_notify.h"
#include "platform/linux/signals.h"
#include "platform/linux/thread.h"

namespace zenith {
namespace {

#if defined(__SANITIZE_THREAD__)
constexpr std::size_t kStack = std::size_t{4096} * 1024;  // the sanitizer keeps its own there, too
#else
constexpr std::size_t kStack = std::size_t{512} * 1024;
#endif
constexpr std::size_t kStackTouched = std::size_t{256} * 1024;
constexpr Duration kTick = {50'000'000};
// After this a thread that does not end is left behind.
constexpr Duration kStopLimit = {800'000'000};

// The threads, and how they end.
class Threads {
 public:
  // False, and logged, when one does not start.
  bool start(ThreadOptions options, std::function<void(const std::atomic<bool>&)> body,
             Report& report) {
    options.stack_bytes = kStack;
    auto& thread = threads_[count_];
    auto& ended = ended_[count_];
    const Status started = thread.start(
        options,
        [this, &ended, body = std::move(body)] {
          body(stop_);
          ended.store(true, std::memory_order_release);
        },
        report);
    if (!started) {
      log_lines(LogLevel::kError, started.error().message);
      return false;
    }
    ++count_;
    return true;
  }

  // False when some are still running after the limit: their data must then stay.
  bool stop(Time now) {
    stop_.store(true, std::memory_order_relaxed);
    const Time limit = now + kStopLimit;
    while (!all_ended() && monotonic_now() < limit)
      sleep_until(monotonic_now() + Duration{2'000'000});
    if (!all_ended()) return false;
    for (Thread& thread : threads_) thread.join();
    return true;
  }

 private:
  bool all_ended() const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!ended_[i].load(std::memory_order_acquire)) return false;
    }
    return true;
  }

  std::atomic<bool> stop_ = false;
  static constexpr std::size_t kMost = 5;
  std::array<Thread, kMost> threads_;
  std::array<std::atomic<bool>, kMost> ended_ = {};
  std::size_t count_ = 0;
};

void serve(Housekeeping& housekeeping, Signals& signals) {
  while (true) {
    const auto request = signals.wait(kTick);
    if (request == SignalRequest::kStop) return;
    const Time now = monotonic_now();
    if (request == SignalRequest::kReload) housekeeping.reload(now);
    housekeeping.tick(now);
  }
}

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

// None without a key, or with one that is no secret: the robot maps alone.
std::unique_ptr<RadioLink> make_radio_link(const DaemonConfig& config, Exchange& exchange) {
  if (!config.radio.enabled || config.radio.key_file.empty()) {
    log_line(LogLevel::kNotice, "radio off: %s; this robot maps alone",
             config.radio.enabled ? "radio.key_file names no key" : "radio.enabled is false");
    return nullptr;
  }
  auto keys = read_fleet_keys(config.radio.key_file);
  if (!keys) {
    log_lines(LogLevel::kError, keys.error().message);
    log_line(LogLevel::kError, "radio off: no key that could be used; this robot maps alone");
    return nullptr;
  }
  log_line(LogLevel::kInfo, "radio: fleet key %s", keys_text(*keys).c_str());
  SessionSettings sessions;
  sessions.keys = *keys;
  sessions.name.assign(config.name);
  sessions.boot = secret_number();
  sessions.secret = SecretKey::random();
  sessions.forget_after = Duration::from_seconds(config.radio.forget_after_s);
  const auto map = static_cast<std::uint32_t>(secret_number());
  return std::make_unique<RadioLink>(config.radio, sessions, map, exchange);
}

// Null when no map is kept.
std::unique_ptr<MapKeeper> make_map_keeper(const DaemonConfig& config, const std::string& path,
                                           storage::Folder& folder) {
  if (path.empty()) {
    log_line(LogLevel::kNotice, "no map is kept: %s",
             config.map.folder.empty() ? "map.folder is empty" : "there is no state folder");
    return nullptr;
  }
  storage::MapHead head;
  head.map = secret_number();
  head.robot.assign(config.name);
  head.camera_height_m = config.mount.z_m;
  head.rectified_fov_deg = config.slam.rectified_fov_deg;
  return std::make_unique<MapKeeper>(folder, head, Duration::from_seconds(config.map.interval_s));
}

void keep_map(MapKeeper& keeper, const Perception& perception, const std::atomic<bool>& stop) {
  const auto report = std::make_unique<PerceptionReport>();
  while (!stop.load(std::memory_order_relaxed)) {
    sleep_until(monotonic_now() + kTick);
    if (perception.read(*report)) keeper.turn_once(monotonic_now(), report->peers.span());
  }
}

[[noreturn]] void leave_without_threads() {
  log_line(LogLevel::kError, "a thread did not end in time: leaving without it");
  process_log().drain(monotonic_now());
  ::_exit(1);
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
  const auto exchange = std::make_unique<Exchange>();
  const tap::DaemonTap tap = tap::make_daemon_tap(config, *devices);
  const auto perception = std::make_unique<Perception>(
      *devices, config.slam, config.seed, live_settings(config), *exchange, tap.tap.get());
  warm_up(devices->robot, config.slam);
  const auto link = make_radio_link(config, *exchange);
  const std::string state = map_folder(config.map.folder);
  storage::DiskFolder folder(state);
  const auto keeper_of_map = make_map_keeper(config, state, folder);
  if (keeper_of_map != nullptr) {
    for (const PastMap& past : keeper_of_map->load()) {
      perception->remember(past.slot, past.whole, past.landmarks);
    }
  }
  const auto cooperation =
      std::make_unique<Cooperation>(*exchange, link.get(), keeper_of_map.get());
  DeviceKeeper keeper(*devices->camera, perception->camera_turn(), *devices->can,
                      perception->can_turn());
  log_line(LogLevel::kInfo, "devices: %s", devices->description.c_str());
  log_line(LogLevel::kInfo, "memory of the algorithm: %zu KiB, for what: --check",
           daemon_memory(config).total() / 1024);

  Report report;
  CpuDmaLatency awake;
  if (config.realtime.hold_cpu_awake) awake.hold(report);
  if (config.realtime.lock_memory) lock_memory(report);
  auto threads = std::make_unique<Threads>();
  const auto cpus = parse_cpus(config.realtime.cpus);
  bool started = threads->start(
      {.name = "zen-perception",
       .fifo_priority = config.realtime.priority,
       .cpus = cpus ? *cpus : 0},
      [&perception](const std::atomic<bool>& stop) {
        prefault_stack(kStackTouched);
        perception->run(stop);
      },
      report);
  started = started && threads->start(
                           {.name = "zen-cooperation"},
                           [&](const std::atomic<bool>& stop) { cooperation->run(stop); }, report);
  started = started && threads->start(
                           {.name = "zen-keeper"},
                           [&](const std::atomic<bool>& stop) { keeper.run(stop); }, report);
  if (keeper_of_map != nullptr) {
    started = started && threads->start(
                             {.name = "zen-map"},
                             [&](const std::atomic<bool>& stop) {
                               keep_map(*keeper_of_map, *perception, stop);
                             },
                             report);
  }
  if (tap.server != nullptr) {
    started = started && threads->start(
                             {.name = "zen-tap"},
                             [&](const std::atomic<bool>& stop) { tap.server->run(stop); }, report);
  }
  log_lines(LogLevel::kWarning, "", report);

  Housekeeping housekeeping(config, file, devices->description, *perception, *cooperation,
                            *exchange, notify, keeper_of_map.get());
  if (started) {
    housekeeping.start(monotonic_now());
    tell_ready(notify);
    log_line(LogLevel::kNotice, LogFields("ready"), "ready");
    serve(housekeeping, signals);
    log_line(LogLevel::kNotice, LogFields("stopping"), "stopping");
  }
  (void)notify.stopping();
  if (!threads->stop(monotonic_now())) leave_without_threads();
  devices->camera->close();
  devices->can->close();
  if (keeper_of_map != nullptr) {
    const auto last = std::make_unique<PerceptionReport>();
    perception->read(*last);
    keeper_of_map->finish(monotonic_now(), last->peers.span());
  }
  housekeeping.finish(monotonic_now());
  return started ? 0 : 1;
}

}  // namespace zenith
