#include "tools/ros2/diagnostics.h"

#include <zenith_ros2_idl/diagnostic_msgs.h>

#include "tools/ros2/convert.h"

namespace zenith::ros2 {
namespace {

using nlohmann::json;
using Level = Diagnosis::Level;

// What is at this place of a line, as text: "" when there is nothing.
std::string text_at(const json& line, const char* pointer) {
  const json::json_pointer place(pointer);
  if (!line.is_object() || !line.contains(place)) return "";
  const json& value = line.at(place);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

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
  const json& health = robot.line("health");
  if (!robot.up() || health.is_null()) {
    out.level = Level::kStale;
    out.message = robot.up() ? "nothing told yet" : text_at(robot.line("link"), "/why");
    return out;
  }
  const std::string state = text_at(health, "/state");
  const std::string reason = text_at(health, "/reason");
  out.level = level_of(state);
  out.message = reason.empty() ? state : state + ": " + reason;
  for (const Place& place : kRobotPlaces) {
    const std::string value = text_at(robot.line(place.line), place.pointer);
    if (!value.empty()) out.values.emplace_back(place.name, value);
  }
  return out;
}

Diagnosis of_alignment(const tools::RobotState& robot, const json& line) {
  Diagnosis out;
  out.name = "zenith: " + robot.name() + ": map of " + text_at(line, "/name");
  out.hardware = robot.name();
  out.message = text_at(line, "/state");
  out.level = out.message == "withdrawn" ? Level::kWarning : Level::kOk;
  for (const Place& place : kPeerPlaces) {
    out.values.emplace_back(place.name, text_at(line, place.pointer));
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
