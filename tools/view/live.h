#pragma once
// Listens to robots and keeps their state: the one thread of `zenith view` and `zenith metrics`
// that talks with daemons.

#include <vector>

#include "platform/base/time.h"
#include "tools/view/fleet_state.h"
#include "tools/view/history.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {

class Live {
 public:
  // `state` must outlive it, and so must `history` where there is one; robots are added to both in
  // this order.
  Live(FleetState& state, std::vector<RobotAddress> robots, History* history = nullptr);

  // Takes what comes within `wait`, or until `wake_fd` can be read (-1: none).
  void turn(Duration wait, int wake_fd);

 private:
  void take(std::size_t robot, std::string_view text, Time now);

  FleetState& state_;
  History* history_;
  std::vector<TelemetryLink> links_;
  Time next_wish_;
};

}  // namespace zenith::tools
