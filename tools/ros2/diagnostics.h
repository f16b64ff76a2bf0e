#pragma once
// How robots are, as ROS 2's diagnostics: rqt_robot_monitor and diagnostic_aggregator read them.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/ros2/participant.h"
#include "tools/view/robot_state.h"

namespace zenith::ros2 {

struct Diagnosis {
  enum class Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2, kStale = 3 };

  Level level = Level::kOk;
  std::string name;      // "zenith: anna"
  std::string message;   // "mapping"
  std::string hardware;  // the robot's name
  std::vector<std::pair<std::string, std::string>> values;
};

// The robot, and each map that it compares with its own.
std::vector<Diagnosis> diagnose(const tools::RobotState& robot);

class Diagnostics {
 public:
  static Result<Diagnostics> make(const Participant& participant);
  Status tell(std::int64_t system_ns, const std::vector<Diagnosis>& list) const;

 private:
  Writer writer_;
};

}  // namespace zenith::ros2
