#include "platform/daemon/housekeeping.h"

#include <algorithm>
#include <cinttypes>
#include <utility>

#include "platform/daemon/picture_lines.h"
#include "platform/daemon/telemetry_lines.h"
#include "platform/daemon/version.h"
#include "platform/linux/clock.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/log.h"

namespace zenith {
namespace {

constexpr Duration kSecond = {1'000'000'000};
constexpr Duration kPicturePeriod = {250'000'000};

// Whether it is time, and if so when it is again.
bool due(Time& next, Time now, Duration period) {
  if (now < next) return false;
  next = now + period;
  return true;
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

const char* event_name(PerceptionEventKind kind) {
  switch (kind) {
    case PerceptionEventKind::kFirstPose:
      return "first-pose";
    case PerceptionEventKind::kCameraLost:
      return "camera-lost";
    case PerceptionEventKind::kPictureFrozen:
      return "camera-frozen";
    case PerceptionEventKind::kPictureMoves:
      return "camera-moves";
    case PerceptionEventKind::kCanLost:
      return "can-lost";
    case PerceptionEventKind::kBusOff:
      return "can-bus-off";
    case PerceptionEventKind::kBusBack:
      return "can-bus-back";
    case PerceptionEventKind::kMerged:
      return "merged";
    case PerceptionEventKind::kWithdrawn:
      return "withdrawn";
    case PerceptionEventKind::kShedding:
      return "load-shed";
    case PerceptionEventKind::kShedNoMore:
      return "load-shed-no-more";
    case PerceptionEventKind::kReasonGiven:
      return "setup-reason";
    case PerceptionEventKind::kReasonWithdrawn:
      return "setup-reason-withdrawn";
    case PerceptionEventKind::kRepaired:
      return "filter-repaired";
  }
  return "";
}

// `peer`: whose map it is about, if it is about one.
LogFields fields_of(const PerceptionEvent& event, const char* peer) {
  LogFields fields(event_name(event.kind));
  if (event.kind == PerceptionEventKind::kShedding) fields.number("ZENITH_CORNERS", event.value);
  if (event.kind == PerceptionEventKind::kReasonGiven ||
      event.kind == PerceptionEventKind::kReasonWithdrawn) {
    fields.text("ZENITH_REASON", event.text);
  }
  if (event.kind == PerceptionEventKind::kRepaired) {
    fields.text("ZENITH_REPAIR", event.text).number("ZENITH_REPAIRS", event.value);
  }
  const bool merged = event.kind == PerceptionEventKind::kMerged;
  if (merged || event.kind == PerceptionEventKind::kWithdrawn) fields.text("ZENITH_PEER", peer);
  if (merged) {
    fields.number("ZENITH_X_M", event.pose.x_m)
        .number("ZENITH_Y_M", event.pose.y_m)
        .number("ZENITH_THETA_RAD", event.pose.theta_rad);
  }
  return fields;
}

}  // namespace

LiveSettings live_settings(const DaemonConfig& config) {
  return {Duration::from_seconds(config.odometry_patience_s),
          {config.load.busy_share, config.load.corners_min, config.slam.corners_max}};
}

Housekeeping::Housekeeping(DaemonConfig config, std::filesystem::path file,
                           const std::string& devices, Perception& perception,
                           Cooperation& cooperation, Exchange& exchange, ServiceNotify& notify,
                           const MapKeeper* map_keeper)
    : config_(std::move(config)),
      file_(std::move(file)),
      devices_(devices),
      perception_(perception),
      cooperation_(cooperation),
      exchange_(exchange),
      notify_(notify),
      map_keeper_(map_keeper) {}

void Housekeeping::start(Time now) {
  started_ = now;
  light_changed_ = now;
  if (config_.telemetry.enabled) {
    const auto path = runtime_path(config_.telemetry.socket);
    const Status opened = path ? telemetry_.open(*path) : Status(path.error());
    if (opened) {
      log_line(LogLevel::kInfo, "telemetry: %s", telemetry_.path().c_str());
    } else {
      log_lines(LogLevel::kWarning, opened.error().message + "; nobody can look");
    }
  }
  make_lights(config_.leds);
}

void Housekeeping::tick(Time now) {
  perception_.read(report_);
  cooperation_.read(link_);
  // After the report: what this says of the stored map holds for all that the report says.
  if (map_keeper_ != nullptr) map_keeper_->read(stored_);
  keep_what_counts(report_, stored_);
  log_events();
  note_wheels();
  note_lately(now);
  const RobotLight before = health_.light;
  health_ = judge_health(report_, lately_, started_, now);
  if (stored_.failing && health_.reason.empty() && report_.has_pose) {
    health_ = {RobotLight::kDegraded, kMapNotKept};
  }
  if (health_.light != before) light_changed_ = now;
  cooperation_.set_light(health_.light);
  show_lights(now);
  send_telemetry(now);
  feed_watchdog(now);
  tell_status(now);
  process_log().drain(now);
}

void Housekeeping::note_wheels() {
  const WheelFault& fault = report_.wheel_fault;
  if (fault.kind == wheel_fault_) return;
  wheel_fault_ = fault.kind;
  if (fault.kind == WheelFaultKind::kNone) {
    return log_line(LogLevel::kNotice, "the wheels are read as wheels again");
  }
  log_lines(LogLevel::kWarning, wheel_fault_text(fault));
}

void Housekeeping::log_event(const PerceptionEvent& event) const {
  const LogFields fields = fields_of(event, link_.name_of(event.peer));
  switch (event.kind) {
    case PerceptionEventKind::kFirstPose:
      return log_line(LogLevel::kNotice, fields, "first pose");
    case PerceptionEventKind::kCameraLost:
      return log_line(LogLevel::kWarning, fields, "camera lost: %s; opening it again", event.text);
    case PerceptionEventKind::kPictureFrozen:
      return log_line(LogLevel::kWarning, fields,
                      "the camera's picture is frozen: the robot moves, and frames with new stamps "
                      "show the same; they are not used");
    case PerceptionEventKind::kPictureMoves:
      return log_line(LogLevel::kNotice, fields, "the camera's picture moves again");
    case PerceptionEventKind::kCanLost:
      return log_line(LogLevel::kWarning, fields, "CAN bus lost: %s; opening it again", event.text);
    case PerceptionEventKind::kBusOff:
      return log_line(LogLevel::kWarning, fields, "the CAN controller left the bus (bus-off)");
    case PerceptionEventKind::kBusBack:
      return log_line(LogLevel::kNotice, fields, "the CAN controller is back on the bus");
    case PerceptionEventKind::kMerged:
      if (event.peer == kPastSlot) {
        return log_line(
            LogLevel::kNotice, fields,
            "found itself in the stored map, whose origin lies at %.2f %.2f m, %.3f rad",
            event.pose.x_m, event.pose.y_m, event.pose.theta_rad);
      }
      if (event.peer >= kPeerSlots) {
        return log_line(LogLevel::kNotice, fields, "found itself in the map of an earlier session");
      }
      return log_line(LogLevel::kNotice, fields,
                      "merged with robot %s: its start lies at %.2f %.2f m, %.3f rad",
                      link_.name_of(event.peer), event.pose.x_m, event.pose.y_m,
                      event.pose.theta_rad);
    case PerceptionEventKind::kWithdrawn:
      if (event.peer >= kPeerSlots) {
        return log_line(LogLevel::kWarning, fields, "it is not where it believed in the %s map",
                        event.peer == kPastSlot ? "stored" : "earlier session's");
      }
      return log_line(LogLevel::kWarning, fields, "the merge with robot %s is withdrawn",
                      link_.name_of(event.peer));
    case PerceptionEventKind::kShedding:
      return log_line(LogLevel::kWarning, fields,
                      "a step takes too long: %d corners for each frame", event.value);
    case PerceptionEventKind::kShedNoMore:
      return log_line(LogLevel::kNotice, fields, "steps are quick enough again: all corners");
    case PerceptionEventKind::kReasonGiven:
      return log_line(LogLevel::kWarning, fields, "set-up %s: %s: %s",
                      verdict_name(event.reason.severity).data(), event.text,
                      reason_text(event.reason).c_str());
    case PerceptionEventKind::kReasonWithdrawn:
      return log_line(LogLevel::kNotice, fields, "set-up: no longer %s", event.text);
    case PerceptionEventKind::kRepaired:
      return log_line(LogLevel::kWarning, fields,
                      "numbers of the filter were not finite or beyond their bounds, and are "
                      "repaired: %s; %d repairs since the start",
                      event.text, event.value);
  }
}

void Housekeeping::log_events() {
  PerceptionEvent event;
  while (perception_.next_event(event)) {
    if (event.peer == kPastSlot && stored_.left) continue;  // of a map that was abandoned
    log_event(event);
  }
}

void Housekeeping::note_lately(Time now) {
  if (!due(next_lately_, now, {5 * kSecond.ns})) return;
  const Deadlines& d = perception_.deadlines();
  const std::uint64_t missed = d.missed.load(std::memory_order_relaxed);
  const Lately totals = {missed + d.met.load(std::memory_order_relaxed), missed};
  lately_ = {totals.frames - lately_before_.frames, totals.missed - lately_before_.missed};
  lately_before_ = totals;
}

// --- lights --------------------------------------------------------------------------------------

void Housekeeping::make_lights(const LedSettings& settings) {
  if (leds_ != nullptr) leds_->close();
  auto made = make_led_output(settings);  // the configuration was checked
  if (made) leds_ = std::move(*made);
  next_leds_open_ = {};
}

void Housekeeping::show_lights(Time now) {
  if (leds_ == nullptr) return;
  if (!leds_->is_open()) {
    if (!due(next_leds_open_, now, {10 * kSecond.ns})) return;
    const Status opened = leds_->open();
    if (!opened) return log_lines(LogLevel::kWarning, "LEDs: " + opened.error().message);
    log_line(LogLevel::kInfo, "LEDs: %s", leds_->description().c_str());
  }
  const Status set = leds_->set(led_pattern(health_.light, now - light_changed_));
  if (!set) log_lines(LogLevel::kWarning, "LEDs: " + set.error().message);
}

// --- telemetry -----------------------------------------------------------------------------------

void Housekeeping::send_telemetry(Time now) {
  JsonLine hello;
  write_hello(hello, config_.name, kVersion, devices_, started_);
  write_clock(hello, system_clock_offset());
  const bool new_reader = telemetry_.accept(hello.finish()) > 0;
  if (new_reader) next_health_ = now;
  if (telemetry_.readers() == 0) return;
  telemetry_.send_maps(exchange_.shown, [this](int slot) { return link_.name_of(slot); });
  send_picture(now);
  if (report_.has_pose && report_.stamp != pose_told_ &&
      due(next_pose_, now, Duration::from_seconds(1.0 / config_.telemetry.rate_hz))) {
    pose_told_ = report_.stamp;
    JsonLine pose;
    write_pose(pose, report_);
    telemetry_.send(pose.finish());
  }
  if (due(next_health_, now, kSecond)) send_second(now);
}

void Housekeeping::send_picture(Time now) {
  if (telemetry_.take_requests(now) && due(next_picture_, now, kPicturePeriod)) {
    perception_.ask_picture();
  }
  const Picture* picture = perception_.next_picture();
  if (picture == nullptr) return;
  CornersLine corners;
  write_corners(corners, *picture);
  telemetry_.send_to_lookers(corners.finish(), now);
  for (int row = 0; row < kRectifiedSize; row += kStripRows) {
    StripLine strip;
    write_strip(strip, *picture, row);
    telemetry_.send_to_lookers(strip.finish(), now);
  }
}

void Housekeeping::send_second(Time now) {
  JsonLine health;
  write_health(health, report_, health_, cooperation_.counters());
  write_clock(health, system_clock_offset());
  telemetry_.send(health.finish());
  VerdictLine verdict;
  write_verdict(verdict, report_.verdict, report_.written);
  telemetry_.send(verdict.finish());
  JsonLine deadlines;
  write_deadlines(deadlines, perception_.deadlines());
  telemetry_.send(deadlines.finish());
  for (const PeerReport& peer : report_.peers) {
    JsonLine line;
    write_alignment(line, peer, link_.name_of(peer.peer), report_.stamp);
    telemetry_.send(line.finish());
  }
  if (map_keeper_ != nullptr) {
    JsonLine stored;
    write_stored_map(stored, stored_, now);
    telemetry_.send(stored.finish());
  }
  JsonLine radio;
  write_radio(radio, link_, now);
  telemetry_.send(radio.finish());
  for (const LinkPeer& peer : link_.peers) {
    JsonLine line;
    write_peer(line, peer, now);
    telemetry_.send(line.finish());
  }
}

// --- the service manager -------------------------------------------------------------------------

void Housekeeping::feed_watchdog(Time now) {
  const auto interval = notify_.watchdog_interval();
  if (!interval || now < next_watchdog_) return;
  const std::uint64_t heartbeat = perception_.heartbeat();
  if (heartbeat == heartbeat_) return;  // the loop does not turn: let the manager see it
  heartbeat_ = heartbeat;
  next_watchdog_ = now + Duration{interval->ns / 4};
  note_manager(notify_.watchdog());
  ++watchdog_fed_;
}

void Housekeeping::tell_status(Time now) {
  if (!due(next_status_, now, kSecond)) return;
  std::string text = status_text(report_, health_);
  if (text == told_status_) return;
  note_manager(notify_.status(text));
  told_status_ = std::move(text);
}

void Housekeeping::note_manager(const Status& told) {
  if (!told && !manager_deaf_) log_lines(LogLevel::kWarning, told.error().message);
  manager_deaf_ = !told;
}

// --- reload --------------------------------------------------------------------------------------

void Housekeeping::reload(Time now) {
  note_manager(notify_.reloading(now));
  auto read = read_daemon_config(file_);
  if (!read) {
    log_lines(LogLevel::kError, LogFields("configuration-wrong"),
              "the configuration stays as it was; " + file_.string() + " is wrong:\n" +
                  read.error().message);
  } else {
    const auto taken = changed_keys(config_, *read, true);
    const auto waiting = changed_keys(config_, *read, false);
    const bool new_lights = std::any_of(taken.begin(), taken.end(), [](const std::string& key) {
      return key.compare(0, 5, "leds.") == 0;
    });
    take_live(*read, config_);
    process_log().set_level(config_.log_level());
    perception_.set_live(live_settings(config_));
    if (new_lights) make_lights(config_.leds);
    log_line(LogLevel::kNotice, LogFields("configuration-read"), "configuration read again: %s",
             taken.empty() ? "nothing that may change now has changed" : join(taken).c_str());
    if (!waiting.empty()) {
      log_line(LogLevel::kWarning, "changed, but needs a restart: %s", join(waiting).c_str());
    }
  }
  reload_keys();
  note_manager(notify_.ready());
}

// From the file that is in use: another one waits for a restart, as all that is not live.
void Housekeeping::reload_keys() {
  if (!config_.radio.enabled || config_.radio.key_file.empty()) return;
  const auto keys = read_fleet_keys(config_.radio.key_file);
  if (!keys) {
    const std::string what = cooperation_.has_link()
                                 ? "the fleet key stays as it was; its file is wrong:\n"
                                 : "the radio stays off; the file of its key is wrong:\n";
    log_lines(LogLevel::kError, what + keys.error().message);
  } else if (!cooperation_.has_link()) {
    log_line(LogLevel::kWarning,
             "the file of the fleet key is right now: a restart turns the radio on");
  } else {
    cooperation_.set_keys(*keys);
    log_line(LogLevel::kNotice, "fleet key read again: %s", keys_text(*keys).c_str());
  }
}

void Housekeeping::finish(Time now) {
  log_events();
  const Deadlines& d = perception_.deadlines();
  const std::uint64_t met = d.met.load(std::memory_order_relaxed);
  const std::uint64_t missed = d.missed.load(std::memory_order_relaxed);
  const std::uint64_t explained = d.explained.load(std::memory_order_relaxed);
  LogFields fields("frames-counted");
  fields.number("ZENITH_IN_TIME", static_cast<double>(met))
      .number("ZENITH_LATE", static_cast<double>(missed))
      .number("ZENITH_LATE_FOR_CPU", static_cast<double>(explained));
  log_line(LogLevel::kNotice, fields,
           "frames in time %" PRIu64 ", late %" PRIu64 ", of these for want of a CPU %" PRIu64, met,
           missed, explained);
  log_line(LogLevel::kInfo, "kernel's wake-up: %s", d.wake_up.text().c_str());
  log_line(LogLevel::kInfo, "step: %s", d.step.text().c_str());
  log_line(LogLevel::kInfo, "computed in it: %s", d.compute.text().c_str());
  log_line(LogLevel::kInfo, "not computed in it: %s", d.stolen.text().c_str());
  log_line(LogLevel::kInfo, "from capture to pose: %s", d.age.text().c_str());
  if (leds_ != nullptr) leds_->close();
  telemetry_.close();
  process_log().drain(now);
}

}  // namespace zenith
