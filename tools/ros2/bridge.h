#pragma once
// What robots tell on their telemetry, as ROS 2's topics: docs/ros2.md.
//
//   map -> odom -> base_link   (REP-105)    /tf, with each pose
//   map -> PEER/map            merged maps  /tf_static, when it changes
//
// One thread; Cyclone DDS has its own.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tools/ros2/diagnostics.h"
#include "tools/ros2/robot_topics.h"
#include "tools/ros2/transforms.h"
#include "tools/view/live.h"

namespace zenith::ros2 {

struct BridgeOptions {
  std::uint32_t domain = 0;
  bool localhost = false;
  FrameNames frames;
  bool prefixed = false;         // names of topics and frames begin with the robot's
  bool transforms = true;        // map -> odom -> base_link
  bool peers_transforms = true;  // map -> PEER/map
};

class Bridge {
 public:
  static Result<std::unique_ptr<Bridge>> start(const BridgeOptions& options,
                                               std::vector<tools::RobotAddress> robots);

  // Takes what comes within `wait`, or until `wake_fd` can be read.
  void turn(Duration wait, int wake_fd);

 private:
  struct Robot {
    std::unique_ptr<RobotTopics> topics;
    std::int64_t system_offset_ns = 0;
    std::int64_t told_ns = 0;           // the last stamp, on the system's clock
    std::map<int, std::uint64_t> maps;  // the version of each owner's landmarks that was told
    std::string link;                   // as logged: "", or why it is down
    bool linked = false;
    bool odometry_missed = false;  // logged
  };

  Bridge(const BridgeOptions& options, std::vector<tools::RobotAddress> robots);
  Status open();
  void hear(std::size_t robot, const tools::TelemetryLine& line);
  void greet(Robot& robot, const std::string& name);
  void tell_motion(Robot& robot, const tools::TelemetryLine& line);
  // Once a second for each robot, when it has told all of that second.
  void tell_maps(Robot& robot, const tools::RobotState& state);
  void tell_peers_frames(const std::vector<tools::RobotState>& states);
  void note_links(const std::vector<tools::RobotState>& states);
  void note(const Status& written);

  const BridgeOptions options_;
  std::optional<Participant> participant_;
  std::optional<Transforms> transforms_;
  std::optional<Diagnostics> diagnostics_;
  std::vector<Robot> robots_;
  std::vector<FrameTransform> fixed_;  // as told
  Time next_second_;
  tools::FleetState state_;
  tools::Live live_;
};

}  // namespace zenith::ros2
