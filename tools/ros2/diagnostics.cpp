#include "tools/ros2/diagnostics.h"

#include <zenith_ros2_idl/diagnostic_msgs.h>

#include "tools/ros2/convert.h"

namespace zenith::ros2 {
namespace {

using Level = Diagnosis::Level;

struct Place {
  const char* name;
  const char* line;  // of the telemetry
  const char* pointer;
};
constexpr Place kRobotPlaces[] = {
    {"version", "hello", "/version"},
    {"devices", "hello", "/devices"},
    {"camera up", "health", "/camera/up"},
    {"camera losses", "health", "/camera/lost"},
    {"CAN up", "health", "/can/up"},
    {"CAN losses", "health", "/can/lost"},
    {"frames", "health", "/map/frames"},
    {"loops closed", "health", "/map/loops_closed"},
    {"frames shed", "health", "/load/frames_shed"},
    {"landmarks agreeing in the last frame", "pose", "/inliers"},
    {"effective sample size", "pose", "/effective_sample_size"},
    {"deadlines met", "deadlines", "/met"},
    {"deadlines missed", "deadlines", "/missed"},
    {"of these for want of a CPU", "deadlines", "/explained"},
    {"step, 99.9 % (ms)", "deadlines", "/step/p999_ms"},
    {"peers heard", "radio", "/peers"},
    {"lines of telemetry that could not be read", "view", "/refused_lines"},
};
constexpr Place kPeerPlaces[] = {
    {"confidence", "", "/confidence"},
    {"correspondences", "", "/correspondences"},
    {"x (m)", "", "/pose/0"},
    {"y (m)", "", "/pose/1"},
    {"theta (rad)", "", "/pose/2"},
    {"variance of x (m2)", "", "/variance/0"},
    {"variance of y (m2)", "", "/variance/1"},
    {"variance of theta (rad2)", "", "/variance/2"},
};

Level level_of(const std::string& state) {
  if (state == "fault") return Level::kError;
  return state == "degraded" ? Level::kWarning : Level::kOk;
}

Diagnosis robot_itself(const tools::RobotState& robot) {
  Diagnosis out;
  out.name = "zenith: " + robot.name();
  out.hardware = robot.name();
  const tools::TelemetryLine& health = robot.line("health");
  if (!robot.up() || health.empty()) {
    out.level = Level::kStale;
    out.message = robot.up() ? "nothing told yet" : robot.line("link").text("/why");
    return out;
  }
  const std::string state = health.text("/state");
  const std::string reason = health.text("/reason");
  out.level = level_of(state);
  out.message = reason.empty() ? state : state + ": " + reason;
  for (const Place& place : kRobotPlaces) {
    const std::string value = robot.line(place.line).text(place.pointer);
    if (!value.empty()) out.values.emplace_back(place.name, value);
  }
  return out;
}

Diagnosis of_alignment(const tools::RobotState& robot, const tools::TelemetryLine& line) {
  Diagnosis out;
  out.name = "zenith: " + robot.name() + ": map of " + line.text("/name");
  out.hardware = robot.name();
  out.message = line.text("/state");
  out.level = out.message == "withdrawn" ? Level::kWarning : Level::kOk;
  for (const Place& place : kPeerPlaces) {
    out.values.emplace_back(place.name, line.text(place.pointer));
  }
  return out;
}

}  // namespace

std::vector<Diagnosis> diagnose(const tools::RobotState& robot) {
  std::vector<Diagnosis> out = {robot_itself(robot)};
  if (out[0].level == Level::kStale) return out;
  for (const auto& [key, line] : robot.lines()) {
    if (key.rfind("alignment/", 0) == 0) out.push_back(of_alignment(robot, line));
  }
  return out;
}

Result<Diagnostics> Diagnostics::make(const Participant& participant) {
  auto writer = Writer::make(participant, "rt/diagnostics", kDiagnostics, {10, false});
  if (!writer) return writer.error();
  Diagnostics out;
  out.writer_ = std::move(*writer);
  return out;
}

Status Diagnostics::tell(std::int64_t system_ns, const std::vector<Diagnosis>& list) const {
  std::vector<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> values;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> statuses;
  for (const Diagnosis& d : list) {
    auto& pairs = values.emplace_back();
    for (const auto& [key, value] : d.values) pairs.push_back({to_text(key), to_text(value)});
    diagnostic_msgs_msg_dds__DiagnosticStatus_ status = {};
    status.level = static_cast<std::uint8_t>(d.level);
    status.name = to_text(d.name);
    status.message = to_text(d.message);
    status.hardware_id = to_text(d.hardware);
    status.values = to_sequence<decltype(status.values)>(pairs);
    statuses.push_back(status);
  }
  const std::string no_frame;
  diagnostic_msgs_msg_dds__DiagnosticArray_ message = {};
  message.header = to_header(system_ns, no_frame);
  message.status = to_sequence<decltype(message.status)>(statuses);
  return writer_.write(&message);
}

}  // namespace zenith::ros2
