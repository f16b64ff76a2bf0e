#include "platform/daemon/running_daemon.h"

#include <unistd.h>

#include <exception>
#include <string>

#include "platform/daemon/memory_report.h"
#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "slam/image/view.h"

namespace zenith {
namespace {

constexpr const char* kPerception = "zen-perception";
constexpr const char* kCooperation = "zen-cooperation";
constexpr const char* kKeeper = "zen-keeper";
constexpr const char* kMap = "zen-map";
constexpr const char* kTap = "zen-tap";
constexpr const char* kClose = "zen-close";

constexpr std::size_t kStackTouched = std::size_t{256} * 1024;
constexpr Duration kTick = {50'000'000};
constexpr Duration kSecond = {1'000'000'000};
// More time than until the manager is asked again, also on a computer that does other things.
constexpr Duration kExtension = {10 * kSecond.ns};

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

std::unique_ptr<MapKeeper> make_map_keeper(const DaemonConfig& config, const RobotConfig& robot,
                                           storage::Folder* maps) {
  if (maps == nullptr) return nullptr;
  storage::MapHead head;
  head.map = secret_number();
  head.robot.assign(config.name);
  head.camera_height_m = config.mount.z_m;
  head.rectified_fov_deg = with_fitted_view(config.slam, robot).rectified_fov_deg;
  return std::make_unique<MapKeeper>(*maps, head, Duration::from_seconds(config.map.interval_s));
}

}  // namespace

RunningDaemon::RunningDaemon(const DaemonConfig& config, const std::filesystem::path& file,
                             Devices& devices, ServiceNotify& notify, storage::Folder* maps)
    : config_(config),
      devices_(devices),
      notify_(notify),
      exchange_(std::make_unique<Exchange>()),
      tap_(tap::make_daemon_tap(config, devices)),
      perception_(std::make_unique<Perception>(devices, config.slam, config.seed,
                                               live_settings(config), *exchange_, tap_.tap.get())),
      link_(make_radio_link(config, *exchange_)),
      map_keeper_(make_map_keeper(config, devices.robot, maps)),
      cooperation_(std::make_unique<Cooperation>(*exchange_, link_.get(), map_keeper_.get())),
      device_keeper_(*devices.camera, perception_->camera_turn(), *devices.can,
                     perception_->can_turn()),
      housekeeping_(std::make_unique<Housekeeping>(config, file, devices.description, *perception_,
                                                   *cooperation_, *exchange_, notify,
                                                   map_keeper_.get())) {
  warm_up(devices.robot, config.slam);
  if (map_keeper_ != nullptr) {
    for (const PastMap& past : map_keeper_->load()) {
      perception_->remember(past.slot, past.whole, past.landmarks);
    }
  }
  log_line(LogLevel::kInfo, "devices: %s", devices.description.c_str());
  log_line(LogLevel::kInfo, "memory of the algorithm: %zu KiB, for what: --check",
           daemon_memory(config).total() / 1024);
}

RunningDaemon::~RunningDaemon() {
  if (!has_ended_) (void)end(1);
}

bool RunningDaemon::failed() const {
  if (realtime_overrun()) {
    log_line(LogLevel::kError, LogFields("failed"),
             "the perception thread computed for %.0f s without a pause and lost its realtime "
             "priority: ending",
             kRealtimeLimit.seconds());
    return true;
  }
  return threads_.failed();
}

int RunningDaemon::run(const std::function<int()>& serve) {
  int code = 1;
  try {
    if (start_threads()) {
      housekeeping_->start(monotonic_now());
      code = serve();
      log_line(LogLevel::kNotice, LogFields("stopping"), "stopping");
    }
  } catch (const std::exception& error) {
    code = 1;
    log_line(LogLevel::kError, LogFields("failed"), "ending because of an error: %s", error.what());
  }
  return end(code);
}

// --- threads -------------------------------------------------------------------------------------

bool RunningDaemon::start_perception(Report& report) {
  const auto cpus = parse_cpus(config_.realtime.cpus);
  ThreadOptions options;
  options.fifo_priority = config_.realtime.priority;
  options.cpus = cpus ? *cpus : 0;
  const auto body = [this](const std::atomic<bool>& stop) {
    prefault_stack(kStackTouched);
    perception_->run(stop);
  };
  return threads_.start(options, kPerception, body, report);
}

bool RunningDaemon::start_threads() {
  Report report;
  if (config_.realtime.hold_cpu_awake) awake_.hold(report);
  if (config_.realtime.priority > 0) limit_realtime(kRealtimeLimit, report);
  if (config_.realtime.lock_memory) lock_memory(report);
  const auto start = [&](const char* name, DaemonThreads::Body body) {
    return threads_.start({}, name, std::move(body), report);
  };
  using Stop = const std::atomic<bool>&;
  const bool started =
      start_perception(report) &&
      start(kCooperation, [this](Stop stop) { cooperation_->run(stop); }) &&
      start(kKeeper, [this](Stop stop) { device_keeper_.run(stop); }) &&
      (map_keeper_ == nullptr || start(kMap, [this](Stop stop) { keep_map(stop); })) &&
      (tap_.server == nullptr || start(kTap, [this](Stop stop) { tap_.server->run(stop); }));
  log_lines(LogLevel::kWarning, "", report);
  return started;
}

// The body of the map's thread. The last checkpoint is its own work, too: a card may hold it up,
// but not the main thread.
void RunningDaemon::keep_map(const std::atomic<bool>& stop) {
  const auto report = std::make_unique<PerceptionReport>();
  while (!stop.load(std::memory_order_relaxed)) {
    sleep_until(monotonic_now() + kTick);
    if (!perception_->read(*report)) continue;
    const bool had_main = !map_keeper_->left_main();
    map_keeper_->turn_once(monotonic_now(), report->peers.span());
    if (had_main && map_keeper_->left_main()) perception_->leave_past();
  }
  while (!told_all_.load(std::memory_order_acquire)) sleep_until(monotonic_now() + kTick);
  if (threads_.ended(kCooperation)) cooperation_->keep_last();
  perception_->read(*report);
  map_keeper_->finish(monotonic_now(), report->peers.span());
}

// --- the end -------------------------------------------------------------------------------------

// Meanwhile the log is written, and the manager hears that the end goes on.
bool RunningDaemon::wait_until(const std::function<bool()>& holds, Duration limit) {
  constexpr Duration kLook = {2'000'000};
  const Time until = monotonic_now() + limit;
  Time next_word;
  while (!holds()) {
    const Time now = monotonic_now();
    if (now >= until) return false;
    if (now >= next_word) {
      next_word = now + kSecond;
      (void)notify_.watchdog();
      (void)notify_.extend_timeout(kExtension);
    }
    process_log().drain(now);
    sleep_until(now + kLook);
  }
  return true;
}

bool RunningDaemon::last_checkpoint() {
  told_all_.store(true, std::memory_order_release);
  if (wait_until([this] { return threads_.ended(kMap); }, kCheckpointLimit)) return true;
  log_line(LogLevel::kError, LogFields("map-not-kept"),
           "the last checkpoint of the map was not written within %.0f s: the disk does not answer",
           kCheckpointLimit.seconds());
  return false;
}

// False when a driver hangs: then one of its threads does.
bool RunningDaemon::close_devices() {
  if (!threads_.ended(kKeeper) || !threads_.ended(kPerception)) return false;
  Report ignored;
  const auto close = [this](const std::atomic<bool>& /*stop*/) {
    devices_.camera->close();
    devices_.can->close();
  };
  if (!threads_.start({}, kClose, close, ignored)) return false;
  return wait_until([this] { return threads_.ended(kClose); }, kThreadLimit);
}

int RunningDaemon::end(int code) {
  has_ended_ = true;
  (void)notify_.stopping();
  threads_.tell_to_stop();
  const auto ours = [this] { return threads_.ended(kPerception) && threads_.ended(kCooperation); };
  (void)wait_until(ours, kThreadLimit);
  if (!last_checkpoint()) code = 1;
  // Those that run no driver's open() have no reason to be late.
  if (!wait_until([&] { return ours() && threads_.ended(kTap); }, kThreadLimit)) code = 1;
  (void)wait_until([this] { return threads_.ended(kKeeper); }, kThreadLimit);
  (void)close_devices();
  housekeeping_->finish(monotonic_now());
  const std::string left = threads_.running();
  if (left.empty()) return code;
  log_line(LogLevel::kWarning, LogFields("left-behind"),
           "left behind, for it did not end in time: %s%s", left.c_str(),
           threads_.ended(kKeeper) && threads_.ended(kClose) ? "" : "; a device does not answer");
  process_log().drain(monotonic_now());
  ::_exit(code);
}

}  // namespace zenith
