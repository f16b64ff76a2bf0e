#include "tools/view/metrics.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace zenith::tools {
namespace {

// Where a metric's value stands: `line` of telemetry, `at` in it (a JSON pointer). `line` may end
// in
// "/*", `at` may have one "*": one sample each, with the name in the place as `label`.
struct Metric {
  const char* name;
  const char* kind;
  const char* help;
  const char* line;
  const char* at;
  const char* label = "";
  double scale = 1.0;
};

constexpr const char* kGauge = "gauge";
constexpr const char* kCounter = "counter";
constexpr double kMilli = 1e-3;

// The distributions of `deadlines` have a label each and a quantile; see quantile_lines().
constexpr const char* kDurations = "zenith_frame_duration_seconds";
constexpr const char* kState = "zenith_state";
constexpr const char* kUp = "zenith_up";

constexpr std::array kMetrics = {
    Metric{"zenith_pose_x_metres", kGauge, "x of base_link in the robot's own start frame, metres",
           "pose", "/pose/0"},
    Metric{"zenith_pose_y_metres", kGauge, "y of base_link in the robot's own start frame, metres",
           "pose", "/pose/1"},
    Metric{"zenith_pose_yaw_radians", kGauge, "heading in the robot's own start frame, radians",
           "pose", "/pose/2"},
    Metric{"zenith_effective_particles", kGauge, "effective sample size of the particle filter",
           "pose", "/effective_sample_size"},
    Metric{"zenith_frame_corners", kGauge, "corners found in the last frame", "pose", "/corners"},
    Metric{"zenith_frame_candidates", kGauge, "landmarks predicted into the last frame", "pose",
           "/candidates"},
    Metric{"zenith_frame_matched", kGauge, "of these, matched to corners", "pose", "/matched"},
    Metric{"zenith_frame_inliers", kGauge, "of these, agreeing on one pose", "pose", "/inliers"},
    Metric{"zenith_step_seconds", kGauge, "what the last frame's step took, seconds", "pose",
           "/step_ms", "", kMilli},
    Metric{"zenith_deadline_seconds", kGauge, "what a step may take: the frames' period, seconds",
           "pose", "/period_ms", "", kMilli},

    Metric{"zenith_camera_up", kGauge, "1: the camera delivers", "health", "/camera/up"},
    Metric{"zenith_camera_frames_total", kCounter, "frames delivered by the camera", "health",
           "/camera/frames"},
    Metric{"zenith_camera_skipped_frames_total", kCounter, "frames skipped for newer ones",
           "health", "/camera/skipped"},
    Metric{"zenith_camera_lost_frames_total", kCounter, "frames lost in the driver", "health",
           "/camera/lost_in_driver"},
    Metric{"zenith_camera_damaged_frames_total", kCounter, "frames that came damaged", "health",
           "/camera/damaged"},
    Metric{"zenith_camera_frozen_frames_total", kCounter,
           "old pictures under new stamps, while the robot moved", "health", "/camera/frozen"},
    Metric{"zenith_camera_unfit_frames_total", kCounter, "frames of another size than the lens",
           "health", "/camera/unfit"},
    Metric{"zenith_camera_losses_total", kCounter, "how often the camera was lost", "health",
           "/camera/lost"},
    Metric{"zenith_can_up", kGauge, "1: the CAN interface is up", "health", "/can/up"},
    Metric{"zenith_can_bus_off", kGauge, "1: the controller has left the bus", "health",
           "/can/bus_off"},
    Metric{"zenith_can_frames_total", kCounter, "CAN frames received", "health", "/can/frames"},
    Metric{"zenith_can_dropped_frames_total", kCounter, "CAN frames dropped by the kernel",
           "health", "/can/dropped"},
    Metric{"zenith_can_error_frames_total", kCounter, "error frames on the bus", "health",
           "/can/error_frames"},
    Metric{"zenith_can_losses_total", kCounter, "how often the CAN interface was lost", "health",
           "/can/lost"},
    Metric{"zenith_wheel_samples_total", kCounter, "samples of the wheels", "health",
           "/wheels/samples"},
    Metric{"zenith_wheel_resets_total", kCounter, "power cycles of the base", "health",
           "/wheels/resets"},
    Metric{"zenith_wheels_late_total", kCounter, "frames that had to do without their wheels",
           "health", "/wheels/late_for_frame"},
    Metric{"zenith_map_frames_total", kCounter, "frames that the algorithm stepped", "health",
           "/map/frames"},
    Metric{"zenith_landmarks_created_total", kCounter, "landmarks created", "health",
           "/map/created"},
    Metric{"zenith_landmarks_promoted_total", kCounter, "landmarks whose height became known",
           "health", "/map/promoted"},
    Metric{"zenith_landmarks_pruned_total", kCounter, "landmarks given up", "health",
           "/map/pruned"},
    Metric{"zenith_landmarks_evicted_total", kCounter, "landmarks evicted from a full map",
           "health", "/map/evicted"},
    Metric{"zenith_landmarks_rejected_total", kCounter, "landmarks without room", "health",
           "/map/rejected_full"},
    Metric{"zenith_loops_closed_total", kCounter, "loops closed", "health", "/map/loops_closed"},
    Metric{"zenith_map_blind_frames_total", kCounter,
           "frames that showed too little of the map: the pose is the wheels'", "health",
           "/map/frames_blind"},
    Metric{"zenith_wheel_slips_total", kCounter, "slips of the wheels that the camera noticed",
           "health", "/map/slips"},
    Metric{"zenith_poses_recovered_total", kCounter,
           "poses found again near where the wheels led, after a slip or a push", "health",
           "/map/poses_recovered"},
    Metric{"zenith_frames_held_total", kCounter,
           "frames that did not fit where the wheels led: not used", "health", "/map/frames_held"},
    Metric{"zenith_times_lost_total", kCounter, "times the robot was lost in its own map", "health",
           "/map/times_lost"},
    Metric{"zenith_relocalised_total", kCounter, "times it was found again in its own map",
           "health", "/map/relocalised"},
    Metric{"zenith_maps_begun_anew_total", kCounter, "young maps of wrong scale that were given up",
           "health", "/map/begun_anew"},
    Metric{"zenith_map_refused_frames_total", kCounter,
           "frames of another size, or whose stamps do not rise", "health", "/map/frames_refused"},
    Metric{"zenith_map_repeated_frames_total", kCounter,
           "frames whose picture is the last one's once more: not used", "health",
           "/map/frames_repeated"},
    Metric{"zenith_odometry_rejected_total", kCounter,
           "samples of the wheels beyond bounds or not newer than the last", "health",
           "/map/odometry_rejected"},
    Metric{"zenith_odometry_jumps_total", kCounter,
           "totals of the wheels that jumped further than they turn", "health",
           "/map/odometry_jumps"},
    Metric{"zenith_records_refused_total", kCounter,
           "peers' landmarks that are not plausible, or found no room", "health",
           "/map/records_refused"},
    Metric{"zenith_filter_repairs_total", kCounter,
           "numbers of the filter that were not finite, or beyond their bounds, by what was done",
           "health", "/repairs/*", "kind"},
    Metric{"zenith_corners_limit", kGauge, "corners of a frame that are taken at most", "health",
           "/load/corners_max"},
    Metric{"zenith_frames_shed_total", kCounter, "frames with fewer corners than configured",
           "health", "/load/frames_shed"},
    Metric{"zenith_page_faults_total", kCounter,
           "page faults of the perception thread since its first frame", "health", "/page_faults/*",
           "kind"},

    Metric{"zenith_deadlines_met_total", kCounter, "steps that took no longer than a period",
           "deadlines", "/met"},
    Metric{"zenith_deadlines_missed_total", kCounter, "steps that took longer", "deadlines",
           "/missed"},
    Metric{"zenith_deadlines_explained_total", kCounter,
           "of these, because the kernel ran something else", "deadlines", "/explained"},

    Metric{"zenith_alignment_confidence", kGauge,
           "agreement of the motions in both maps (the paper's Eq. 4), 0 to 1", "alignment/*",
           "/confidence", "peer"},
    Metric{"zenith_alignment_correspondences", kGauge, "pairs of landmarks that hold the alignment",
           "alignment/*", "/correspondences", "peer"},

    Metric{"zenith_view_refused_lines_total", kCounter,
           "lines of telemetry that zenith view could not read, by reason", "view",
           "/refused_lines/*", "reason"},
    Metric{"zenith_view_peers_evicted_total", kCounter,
           "names of peers given up by zenith view for new ones: the longest silent first", "view",
           "/full/peers_evicted"},
    Metric{"zenith_view_landmarks_refused_total", kCounter,
           "landmarks for which zenith view had no room", "view", "/full/landmarks_refused"},

    Metric{"zenith_radio_open", kGauge, "1: there are sockets", "radio", "/open"},
    Metric{"zenith_radio_peers", kGauge, "robots that are heard", "radio", "/peers"},
    Metric{"zenith_radio_sent_datagrams_total", kCounter, "datagrams sent, each copy counted",
           "radio", "/udp/sent"},
    Metric{"zenith_radio_received_datagrams_total", kCounter, "datagrams received", "radio",
           "/udp/received"},
    Metric{"zenith_radio_sent_bytes_total", kCounter, "bytes sent, headers included", "radio",
           "/link/sent_bytes"},
    Metric{"zenith_radio_received_bytes_total", kCounter, "bytes of verified peers", "radio",
           "/link/received_bytes"},
    Metric{"zenith_radio_rejected_datagrams_total", kCounter, "datagrams rejected, by reason",
           "radio", "/rejected/*", "reason"},
    Metric{"zenith_exchange_records_received_total", kCounter, "records of landmarks received",
           "radio", "/exchange/records_received"},
    Metric{"zenith_exchange_faults_total", kCounter, "faults of peers", "radio",
           "/exchange/faults"},
    Metric{"zenith_exchange_quarantines_total", kCounter, "peers that were not listened to",
           "radio", "/exchange/quarantines"},
    Metric{"zenith_peer_age_seconds", kGauge, "since the peer was heard, seconds", "peer/*",
           "/age_s", "peer"},
    Metric{"zenith_peer_landmarks", kGauge, "landmarks of the peer's map", "peer/*", "/landmarks",
           "peer"},
    Metric{"zenith_peer_complete", kGauge, "1: all that the peer told of is here", "peer/*",
           "/complete", "peer"},
};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

using Labels = std::vector<std::pair<std::string, std::string>>;

void put_sample(std::string& out, const char* name, const Labels& labels, double number,
                double scale) {
  out += name;
  out += '{';
  for (const auto& [label, text] : labels) {
    out += (out.back() == '{' ? "" : ",") + label + "=\"" + escaped(text) + '"';
  }
  std::array<char, 48> digits;
  std::snprintf(digits.data(), digits.size(), "} %.15g\n", scale * number);
  out += digits.data();
}

void put_header(std::string& out, const char* name, const char* kind, const char* help) {
  out += std::string("# HELP ") + name + " " + help + "\n# TYPE " + name + " " + kind + "\n";
}

// One of the last place's names each, or the one value.
void put_values(std::string& out, const Metric& metric, const TelemetryLine& line,
                const Labels& labels) {
  const std::string at = metric.at;
  if (at.back() != '*') {
    const auto value = line.number(at);
    if (value) put_sample(out, metric.name, labels, *value, metric.scale);
    return;
  }
  for (const auto& [key, value] : line.numbers_below(at.substr(0, at.size() - 2))) {
    Labels more = labels;
    more.emplace_back(metric.label, key);
    put_sample(out, metric.name, more, value, metric.scale);
  }
}

void put_metric(std::string& out, const Metric& metric, const RobotState& robot) {
  const Labels labels = {{"robot", robot.name()}};
  const std::string line = metric.line;
  if (line.back() != '*') return put_values(out, metric, robot.line(line), labels);
  const std::string prefix = line.substr(0, line.size() - 1);
  for (const auto& [key, value] : robot.lines()) {
    if (key.compare(0, prefix.size(), prefix) != 0) continue;
    Labels more = labels;
    more.emplace_back(metric.label, key.substr(prefix.size()));
    put_values(out, metric, value, more);
  }
}

void put_durations(std::string& out, const RobotState& robot) {
  const TelemetryLine& line = robot.line("deadlines");
  for (const char* what : {"wake_up", "step", "compute", "stolen", "age"}) {
    for (const auto& [key, quantile] :
         {std::pair{"p50_ms", "0.5"}, {"p95_ms", "0.95"}, {"p999_ms", "0.999"}, {"max_ms", "1"}}) {
      const auto value = line.number(std::string("/") + what + "/" + key);
      if (!value) continue;
      put_sample(out, kDurations, {{"robot", robot.name()}, {"what", what}, {"quantile", quantile}},
                 *value, kMilli);
    }
  }
}

void put_states(std::string& out, const RobotState& robot) {
  const TelemetryLine& health = robot.line("health");
  if (health.empty()) return;
  for (const char* state : {"starting", "mapping", "merged", "degraded", "fault"}) {
    put_sample(out, kState, {{"robot", robot.name()}, {"state", state}},
               health.text("/state") == state ? 1.0 : 0.0, 1.0);
  }
}

void put_merges(std::string& out, const RobotState& robot) {
  for (const auto& [key, line] : robot.lines()) {
    const auto* alignment = line.as<AlignmentLine>();
    if (alignment == nullptr) continue;
    put_sample(out, "zenith_merged", {{"robot", robot.name()}, {"peer", alignment->name}},
               alignment->state == "merged" ? 1.0 : 0.0, 1.0);
  }
}

// Those that are no plain value of a line.
struct Special {
  MetricText text;
  void (*put)(std::string&, const RobotState&);
};

const std::array<Special, 4>& specials() {
  static const std::array<Special, 4> kSpecials = {{
      {{kUp, kGauge, "robot", "1: its daemon tells"},
       [](std::string& out, const RobotState& robot) {
         put_sample(out, kUp, {{"robot", robot.name()}}, robot.up() ? 1.0 : 0.0, 1.0);
       }},
      {{kState, kGauge, "robot, state", "1: the state that its lights show"}, put_states},
      {{"zenith_merged", kGauge, "robot, peer", "1: the peer's map is one with the own"},
       put_merges},
      {{kDurations, kGauge, "robot, what, quantile",
        "distributions since the start, seconds: wake_up, how late a wait ended; step, compute and "
        "stolen of a frame; age, from the capture to the pose"},
       put_durations},
  }};
  return kSpecials;
}

}  // namespace

std::string metrics_text(const FleetState& state) {
  std::string out;
  state.read([&](const std::vector<RobotState>& robots) {
    for (const Special& special : specials()) {
      put_header(out, special.text.name.c_str(), special.text.kind.c_str(),
                 special.text.help.c_str());
      for (const RobotState& robot : robots) special.put(out, robot);
    }
    for (const Metric& metric : kMetrics) {
      std::string samples;
      for (const RobotState& robot : robots) put_metric(samples, metric, robot);
      if (samples.empty()) continue;
      put_header(out, metric.name, metric.kind, metric.help);
      out += samples;
    }
  });
  return out;
}

std::span<const MetricText> metric_texts() {
  static const std::vector<MetricText> kTexts = [] {
    std::vector<MetricText> texts;
    for (const Special& special : specials()) texts.push_back(special.text);
    for (const Metric& metric : kMetrics) {
      const std::string label = metric.label;
      texts.push_back(
          {metric.name, metric.kind, label.empty() ? "robot" : "robot, " + label, metric.help});
    }
    return texts;
  }();
  return kTexts;
}

}  // namespace zenith::tools
