#pragma once
// How the robot is, from the perception thread's report: what its lights show and one line for a
// person. Pure.

#include <string>

#include "drivers/leds/led_pattern.h"
#include "platform/base/time.h"
#include "platform/daemon/perception_report.h"

namespace zenith {

struct Health {
  RobotLight light = RobotLight::kStarting;
  std::string reason;  // why it is not mapping: "no frames from the camera"; empty when it is
};

// Devices may be away for so long before somebody has to come.
inline constexpr Duration kFaultAfter = {15'000'000'000};
// No frame, or no wheels, for so long: something is missing.
inline constexpr Duration kDegradedAfter = {1'500'000'000};
// A filter that had to repair its numbers is watched for so long.
inline constexpr Duration kDegradedAfterRepair = {10'000'000'000};
// The verdict on camera, wheels and clocks, by its gravest active reason.
inline constexpr const char* kSetupWrong = "the set-up is wrong";
inline constexpr const char* kSetupDoubtful = "the set-up is doubtful";
// What the wheels' codec reads cannot be wheels: wheel_fault_text() says why.
inline constexpr const char* kWheelsReadWrong = "the wheels are read wrong";
inline constexpr const char* kWheelStands = "one wheel never moved";
// A reason that perception does not know of.
inline constexpr const char* kMapNotKept = "the map cannot be kept";

// `missed_lately`: deadlines missed in the last seconds, out of `frames_lately`.
struct Lately {
  std::uint64_t frames = 0;
  std::uint64_t missed = 0;
};

Health judge_health(const PerceptionReport& report, const Lately& lately, Time started, Time now);

// "starting", "mapping", "merged", "degraded", "fault", "stopped"
const char* light_name(RobotLight light);

// "mapping, 3.21 1.05 m, 12.5 deg, 918 landmarks promoted, merged with 1 peer"
std::string status_text(const PerceptionReport& report, const Health& health);

}  // namespace zenith
