#pragma once
// Listens to robots and keeps their state: the one thread of `zenith view` and `zenith metrics`
// that talks with daemons.

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "platform/base/time.h"
#include "tools/view/fleet_state.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {

class Live {
 public:
  // After each line: the robot's number, the line that the state has just taken in, and its text.
  // What is no line of telemetry is counted, and logged once a minute for each kind of fault.
  using Heard = std::function<void(std::size_t robot, const TelemetryLine& line,
                                   std::string_view text, Time now)>;

  // `state` must outlive it; robots are added to it in this order.
  Live(FleetState& state, std::vector<RobotAddress> robots, Heard heard = {});

  // Takes what comes within `wait`, or until `wake_fd` can be read (-1: none).
  void turn(Duration wait, int wake_fd);

 private:
  void take(std::size_t robot, std::string_view text, Time now);
  void refuse(std::size_t robot, const DecodedLine& decoded, Time now);

  FleetState& state_;
  const Heard heard_;
  std::vector<TelemetryLink> links_;
  std::vector<std::array<Time, kLineFaults>> next_log_;  // of each robot, by fault
  Time next_wish_;
};

}  // namespace zenith::tools
