#include "platform/daemon/telemetry_lines.h"

#include <algorithm>
#include <array>

#include "drivers/radio/endpoint_text.h"

namespace zenith {
namespace {

std::array<double, 3> numbers_of(const Pose2& pose) {
  return {pose.x_m, pose.y_m, pose.theta_rad};
}

unsigned long long ns_of(Time time) {
  return static_cast<unsigned long long>(time.ns);
}

// 0: not known.
double rate_hz(Duration period) {
  return period.ns > 0 ? 1.0 / period.seconds() : 0.0;
}

void write_camera(JsonLine& line, const PerceptionReport& report) {
  const CameraCounters& c = report.camera;
  line.begin("camera")
      .flag("up", report.camera_up)
      .number("agreed_hz", rate_hz(report.agreed_period))
      .number("measured_hz", rate_hz(report.measured_period))
      .count("frames", c.frames)
      .count("skipped", c.skipped)
      .count("lost_in_driver", c.lost_in_driver)
      .count("damaged", c.damaged)
      .count("unfit", report.frames_unfit)
      .count("frozen", report.frames_frozen)
      .count("stamps_replaced", c.stamps_replaced)
      .count("opened", c.opened)
      .count("lost", c.lost)
      .count("stalled", c.stalled)
      .count("abandoned", c.abandoned)
      .end();
}

void write_can(JsonLine& line, const PerceptionReport& report) {
  const CanCounters& c = report.can;
  line.begin("can")
      .flag("up", report.can_up)
      .flag("bus_off", report.bus_off)
      .count("frames", c.frames)
      .count("dropped", c.dropped)
      .count("error_frames", c.error_frames)
      .count("bus_offs", c.bus_off)
      .count("opened", c.opened)
      .count("lost", c.lost)
      .end();
  const WheelDecoderCounters& w = report.wheels;
  line.begin("wheels")
      .count("samples", w.samples)
      .count("resets", w.resets)
      .count("refused", w.late + w.short_frames + w.invalid)
      .count("unpaired", w.unpaired)
      .count("error_reports", w.error_reports)
      .count("late_for_frame", report.wheels_late)
      .text("fault", wheel_fault_text(report.wheel_fault))
      .end();
}

void write_map(JsonLine& line, const StepCounters& steps) {
  const MapperCounters& m = steps.mapper;
  line.begin("map")
      .count("frames", steps.frames)
      .count("frames_refused", steps.frames_refused)
      .count("frames_repeated", steps.frames_repeated)
      .count("odometry_extrapolated", steps.odometry_extrapolated)
      .count("odometry_rejected", steps.odometry_rejected)
      .count("odometry_jumps", steps.odometry_jumps)
      .count("records_refused", steps.records_refused)
      .count("calls_refused", steps.calls_refused)
      .count("created", m.landmarks_created)
      .count("promoted", m.landmarks_promoted)
      .count("pruned", m.landmarks_pruned)
      .count("evicted", m.landmarks_evicted)
      .count("rejected_full", m.landmarks_rejected_full)
      .count("loops_closed", m.loops_closed)
      .count("slips", m.slips)
      .count("poses_recovered", m.poses_recovered)
      .count("frames_held", m.frames_held)
      .count("times_lost", m.times_lost)
      .count("relocalised", m.relocalised)
      .count("frames_blind", m.frames_blind)
      .count("begun_anew", m.begun_anew)
      .count("resamplings", m.resamplings)
      .end();
  line.begin("repairs");
  for (const RepairKind& kind : kRepairKinds) line.count(kind.name, m.repairs.*kind.count);
  line.end();
}

void write_histogram(JsonLine& line, std::string_view key, const LatencyHistogram& live) {
  const LatencyHistogram h = live;  // figures that belong together
  line.begin(key)
      .count("count", h.count())
      .number("p50_ms", h.percentile(0.5).seconds() * 1e3)
      .number("p95_ms", h.percentile(0.95).seconds() * 1e3)
      .number("p999_ms", h.percentile(0.999).seconds() * 1e3)
      .number("max_ms", h.longest().seconds() * 1e3)
      .end();
}

}  // namespace

void write_hello(JsonLine& line, std::string_view robot, std::string_view version,
                 std::string_view devices, Time started) {
  line.text("type", "hello")
      .text("robot", robot)
      .text("version", version)
      .text("devices", devices)
      .count("started_ns", ns_of(started));
}

void write_clock(JsonLine& line, Duration system_offset) {
  const auto offset = static_cast<unsigned long long>(std::max<std::int64_t>(system_offset.ns, 0));
  line.count("system_offset_ns", offset);
}

void write_pose(JsonLine& line, const PerceptionReport& report) {
  line.text("type", "pose")
      .count("stamp_ns", ns_of(report.stamp))
      .numbers("pose", numbers_of(report.T_start_robot))
      .numbers("covariance", report.covariance)
      .number("effective_sample_size", report.effective_sample_size)
      .text("tracking", state_name(report.tracking))
      .number("corners", report.corners)
      .number("candidates", report.candidates)
      .number("matched", report.matched)
      .number("inliers", report.inliers)
      .number("step_ms", report.step.seconds() * 1e3)
      .number("period_ms", report.period.seconds() * 1e3);
  if (const PeerReport* past = past_self(report)) {
    line.numbers("map_pose", numbers_of(past->T_own_peer.inverse() * report.T_start_robot));
  }
  line.begin("odometry")
      .numbers("pose", numbers_of(report.T_odom_robot))
      .numbers("covariance", report.odometry_covariance)
      .numbers("velocity", report.velocity)
      .numbers("velocity_covariance", report.velocity_covariance)
      .end();
}

void write_stored_map(JsonLine& line, const MapStatus& status, Time now) {
  line.text("type", "stored_map")
      .text("place", status.place.view())
      .count("checkpoint", status.checkpoint)
      .number("age_s", status.written > 0 ? (now - status.last).seconds() : -1.0)
      .count("landmarks", status.landmarks)
      .count("past_landmarks", status.past)
      .count("sessions", status.sessions)
      .flag("found", status.found)
      .flag("left", status.left)
      .count("written", status.written)
      .count("failed", status.failed)
      .count("bytes", status.bytes)
      .flag("failing", status.failing)
      .text("error", status.error.view());
}

void write_alignment(JsonLine& line, const PeerReport& peer, std::string_view name, Time stamp) {
  line.text("type", "alignment")
      .count("stamp_ns", ns_of(stamp))
      .number("peer", peer.peer)
      .text("name", name)
      .text("state", state_name(peer.state))
      .numbers("pose", numbers_of(peer.T_own_peer))
      .numbers("variance", peer.variance)
      .number("confidence", peer.confidence)
      .number("correspondences", peer.correspondences);
}

void write_health(JsonLine& line, const PerceptionReport& report, const Health& health,
                  const CooperationCounters& cooperation) {
  line.text("type", "health")
      .count("stamp_ns", ns_of(report.written))
      .text("state", light_name(health.light))
      .text("reason", health.reason);
  write_camera(line, report);
  write_can(line, report);
  write_map(line, report.steps);
  line.begin("load")
      .number("corners_max", report.corners_max)
      .count("frames_shed", report.frames_shed)
      .end();
  line.begin("cooperation")
      .count("sent", cooperation.sent)
      .count("unheard", cooperation.unheard)
      .count("received", cooperation.received)
      .end();
  line.begin("page_faults")
      .count("minor", report.faults.minor)
      .count("major", report.faults.major)
      .end();
}

void write_verdict(VerdictLine& line, const SetupVerdict& verdict, Time now) {
  line.text("type", "verdict")
      .count("stamp_ns", ns_of(now))
      .text("state", verdict_name(verdict.state));
  line.begin("reasons");
  for (const Reason& reason : verdict.reasons) {
    line.begin(setup_code_name(reason.code))
        .text("severity", verdict_name(reason.severity))
        .text("text", reason_text(reason).view())
        .number("since_s", reason.since_s)
        .flag("active", reason.active)
        .end();
  }
  line.end();
}

void write_radio(JsonLine& line, const LinkStatus& status, Time now) {
  line.text("type", "radio")
      .count("stamp_ns", ns_of(now))
      .flag("enabled", status.enabled)
      .flag("open", status.open)
      .count("peers", status.peers.size());
  const RadioCounters& r = status.radio;
  line.begin("udp")
      .count("sent", r.sent)
      .count("received", r.received)
      .count("dropped", r.dropped)
      .count("too_long", r.too_long)
      .count("unreachable", r.unreachable)
      .count("no_buffer", r.no_buffer)
      .count("forbidden", r.forbidden)
      .count("not_sent", r.not_sent)
      .end();
  const LinkCounters& l = status.link;
  line.begin("link")
      .count("sent_bytes", l.sent_bytes)
      .count("received", l.received)
      .count("received_bytes", l.received_bytes)
      .count("challenges", l.challenges)
      .count("responses", l.responses)
      .count("verified", l.verified)
      .end();
  line.begin("rejected");
  for (std::size_t i = 0; i < l.rejected.size(); ++i) {
    line.count(rejected_name(static_cast<Rejected>(i)), l.rejected[i]);
  }
  line.end();
  const exchange::Counters& e = status.exchange;
  line.begin("exchange")
      .count("news_sent", e.news_sent)
      .count("served_sent", e.served_sent)
      .count("requests_sent", e.requests_sent)
      .count("requests_received", e.requests_received)
      .count("records_received", e.records_received)
      .count("records_new", e.records_new)
      .count("no_room", e.no_room)
      .count("faults", e.malformed + e.inconsistent + e.too_much)
      .count("quarantines", e.quarantines)
      .count("checksum_differed", e.checksum_differed)
      .end();
}

void write_peer(JsonLine& line, const LinkPeer& peer, Time now) {
  line.text("type", "peer")
      .text("name", peer.name.view())
      .text("address", endpoint_text(peer.address))
      .number("peer", peer.slot)
      .number("age_s", (now - peer.heard).seconds())
      .flag("complete", peer.complete)
      .count("landmarks", peer.landmarks)
      .flag("quarantined", peer.quarantined);
  if (peer.has_pose) line.numbers("pose", numbers_of(peer.T_start_robot));
}

void write_deadlines(JsonLine& line, const Deadlines& deadlines) {
  line.text("type", "deadlines")
      .count("met", deadlines.met.load(std::memory_order_relaxed))
      .count("missed", deadlines.missed.load(std::memory_order_relaxed))
      .count("explained", deadlines.explained.load(std::memory_order_relaxed));
  write_histogram(line, "wake_up", deadlines.wake_up);
  write_histogram(line, "step", deadlines.step);
  write_histogram(line, "compute", deadlines.compute);
  write_histogram(line, "stolen", deadlines.stolen);
  write_histogram(line, "age", deadlines.age);
}

}  // namespace zenith
