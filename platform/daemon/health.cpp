#include "platform/daemon/health.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

namespace zenith {
namespace {

constexpr double kMissedShare = 0.1;

int merged_peers(const PerceptionReport& report) {
  int count = 0;
  for (const PeerReport& peer : report.peers) {
    count += peer.state == AlignmentState::kMerged && peer.peer < kPeerSlots;
  }
  return count;
}

// The gravest that is active; a robot that was not judged yet is as well as any.
const Reason* active_reason(const SetupVerdict& verdict) {
  for (const Reason& reason : verdict.reasons) {
    if (reason.active && reason.code != SetupCode::kNotJudgedYet) return &reason;
  }
  return nullptr;
}

std::string wheel_reason(const WheelFault& fault) {
  switch (fault.kind) {
    case WheelFaultKind::kNone:
      break;
    case WheelFaultKind::kNonsense:
    case WheelFaultKind::kWraps:
      return kWheelsReadWrong;
    case WheelFaultKind::kLeftStands:
    case WheelFaultKind::kRightStands:
      return kWheelStands;
  }
  return "";
}

}  // namespace

const char* light_name(RobotLight light) {
  switch (light) {
    case RobotLight::kStarting:
      return "starting";
    case RobotLight::kMapping:
      return "mapping";
    case RobotLight::kMerged:
      return "merged";
    case RobotLight::kDegraded:
      return "degraded";
    case RobotLight::kFault:
      return "fault";
    case RobotLight::kStopped:
      return "stopped";
  }
  return "?";
}

Health judge_health(const PerceptionReport& report, const Lately& lately, Time started, Time now) {
  const Duration without_frames = now - std::max(report.last_frame, started);
  const Duration without_wheels = now - std::max(report.last_wheels, started);
  const bool no_frames = without_frames > kDegradedAfter;
  const bool no_wheels = without_wheels > kDegradedAfter;
  std::string reason;
  if (report.camera_frozen && (report.camera_up || !no_frames)) {
    reason = "the camera's picture is frozen";
  } else if (no_frames) {
    reason = report.camera_up ? "no frames from the camera" : "no camera";
  } else if (no_wheels) {
    reason = report.bus_off   ? "the CAN bus is off"
             : !report.can_up ? "no CAN bus"
                              : "nothing from the wheels on the CAN bus";
  }
  if (reason.empty()) reason = wheel_reason(report.wheel_fault);
  if (std::max(without_frames, without_wheels) > kFaultAfter) return {RobotLight::kFault, reason};
  if (!report.has_pose) return {RobotLight::kStarting, reason};
  if (!reason.empty()) return {RobotLight::kDegraded, reason};
  const Reason* worst = active_reason(report.verdict);
  if (worst != nullptr && worst->severity == VerdictState::kWrong) {
    return {RobotLight::kDegraded, kSetupWrong};
  }
  if (report.tracking == TrackingState::kLost) {
    return {RobotLight::kDegraded, "lost: the ceiling is not that of where the robot should be"};
  }
  if (worst != nullptr) {
    return {RobotLight::kDegraded, kSetupDoubtful};
  }
  if (report.repaired && now - report.last_repair < kDegradedAfterRepair) {
    return {RobotLight::kDegraded, "the filter had to repair its numbers"};
  }
  const double missed = static_cast<double>(lately.missed);
  if (lately.frames > 0 && missed > kMissedShare * static_cast<double>(lately.frames)) {
    return {RobotLight::kDegraded, "deadlines are missed"};
  }
  if (report.sheds) return {RobotLight::kDegraded, "the computer is too slow: fewer corners"};
  return {merged_peers(report) > 0 ? RobotLight::kMerged : RobotLight::kMapping, ""};
}

std::string status_text(const PerceptionReport& report, const Health& health) {
  std::string text = light_name(health.light);
  if (!health.reason.empty()) text += ": " + health.reason;
  const bool setup = health.reason == kSetupWrong || health.reason == kSetupDoubtful;
  if (const Reason* worst = active_reason(report.verdict); setup && worst != nullptr) {
    text += " (" + std::string(setup_code_name(worst->code)) + ")";
  }
  if (!report.has_pose) return text;
  char pose[128];
  std::snprintf(pose, sizeof pose, ", at %.2f %.2f m, %.1f deg, %llu landmarks promoted",
                report.T_start_robot.x_m, report.T_start_robot.y_m,
                report.T_start_robot.theta_rad * 180.0 / std::numbers::pi,
                static_cast<unsigned long long>(report.steps.mapper.landmarks_promoted));
  text += pose;
  const int merged = merged_peers(report);
  if (merged > 0) text += ", merged with " + std::to_string(merged) + " peers";
  return text;
}

}  // namespace zenith
