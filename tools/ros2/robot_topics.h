#pragma once
// One robot's topics.
//
//   odom                    nav_msgs/msg/Odometry: by the wheels alone, odom -> base_link
//   pose                    geometry_msgs/msg/PoseWithCovarianceStamped in its map
//   landmarks               sensor_msgs/msg/PointCloud2 in its map; latched
//   peers/NAME/alignment    geometry_msgs/msg/PoseWithCovarianceStamped: where that robot's map
//                           lies in this one's
//   peers/NAME/confidence   std_msgs/msg/Float32, 0 to 1
//   peers/NAME/landmarks    sensor_msgs/msg/PointCloud2 in that robot's map; latched

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "platform/base/time.h"
#include "tools/ros2/motion.h"
#include "tools/ros2/names.h"
#include "tools/ros2/participant.h"
#include "tools/view/robot_state.h"

namespace zenith::ros2 {

class RobotTopics {
 public:
  using Rows = std::vector<tools::RobotState::Row>;
  // Names that are heard at a time. For a further one the topics of the longest silent peer end,
  // once it has told nothing for kSilence.
  static constexpr std::size_t kPeers = 64;
  static constexpr Duration kSilence = {5'000'000'000};

  // `participant` must outlive it.
  static Result<std::unique_ptr<RobotTopics>> make(const Participant& participant,
                                                   RobotNames names);

  const RobotNames& names() const { return names_; }

  Status tell_motion(const Motion& motion) const;
  Status tell_landmarks(std::int64_t system_ns, const Rows& rows) const;
  Status tell_alignment(std::int64_t system_ns, const tools::AlignmentLine& line);
  Status tell_peer_landmarks(const std::string& peer, std::int64_t system_ns, const Rows& rows);

 private:
  struct Peer {
    std::string name;  // as it was told: two names never share topics
    Time used;
    Writer alignment;
    Writer confidence;
    Writer landmarks;
  };

  RobotTopics(const Participant& participant, RobotNames names)
      : participant_(participant), names_(std::move(names)) {}
  Result<const Peer*> peer(const std::string& name);
  Status make_room(const std::string& name, Time now);

  const Participant& participant_;
  const RobotNames names_;
  Writer odom_;
  Writer pose_;
  Writer landmarks_;
  std::map<std::string, Peer> peers_;  // by what ROS 2 calls them
};

}  // namespace zenith::ros2
