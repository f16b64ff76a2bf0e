#include "tools/ros2/robot_topics.h"

#include <algorithm>

#include <zenith_ros2_idl/geometry_msgs.h>
#include <zenith_ros2_idl/nav_msgs.h>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "tools/ros2/convert.h"
#include "tools/ros2/landmark_cloud.h"

namespace zenith::ros2 {
namespace {

constexpr Quality kStream = {10, false};
constexpr Quality kMap = {1, true};

struct Wanted {
  Writer* writer;
  std::string topic;
  const TopicType* type;
  Quality quality;
};

Status make_all(const Participant& participant, const std::vector<Wanted>& list) {
  for (const Wanted& wanted : list) {
    auto made = Writer::make(participant, wanted.topic, *wanted.type, wanted.quality);
    if (!made) return made.error();
    *wanted.writer = std::move(*made);
  }
  return {};
}

Status write_pose(const Writer& writer, std::int64_t system_ns, const std::string& frame,
                  const Pose2& pose, const PlanarCovariance& covariance) {
  geometry_msgs_msg_dds__PoseWithCovarianceStamped_ message = {};
  message.header = to_header(system_ns, frame);
  message.pose.pose = to_pose(pose);
  put_covariance(covariance, message.pose.covariance);
  return writer.write(&message);
}

Status write_cloud(const Writer& writer, std::int64_t system_ns, std::string frame,
                   const RobotTopics::Rows& rows) {
  const LandmarkCloud cloud(system_ns, std::move(frame), rows);
  return writer.write(&cloud.message());
}

}  // namespace

Result<std::unique_ptr<RobotTopics>> RobotTopics::make(const Participant& participant,
                                                       RobotNames names) {
  std::unique_ptr<RobotTopics> out(new RobotTopics(participant, std::move(names)));
  const RobotNames& n = out->names_;
  const Status made =
      make_all(participant, {{&out->odom_, n.topic("odom"), &kOdometry, kStream},
                             {&out->pose_, n.topic("pose"), &kPoseWithCovarianceStamped, kStream},
                             {&out->landmarks_, n.topic("landmarks"), &kPointCloud, kMap}});
  if (!made) return made.error();
  return out;
}

Status RobotTopics::make_room(const std::string& name, Time now) {
  if (peers_.size() < kPeers) return {};
  const auto oldest =
      std::min_element(peers_.begin(), peers_.end(),
                       [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
  if (now - oldest->second.used < kSilence) {
    return Error{"more than " + std::to_string(kPeers) +
                 " robots are heard at a time: no topics for " + name + " until one falls silent"};
  }
  log_line(LogLevel::kWarning, "the topics of %s end: it is silent, and %s is heard",
           oldest->first.c_str(), name.c_str());
  peers_.erase(oldest);
  return {};
}

Result<const RobotTopics::Peer*> RobotTopics::peer(const std::string& name) {
  const Time now = monotonic_now();
  const std::string own = ros_name(name);
  const auto found = peers_.find(own);
  if (found != peers_.end()) {
    if (found->second.name != name) {
      return Error{"robots " + found->second.name + " and " + name + " would share the topics " +
                   own + ": none for the second; give it another name"};
    }
    found->second.used = now;
    return &found->second;
  }
  if (const Status room = make_room(name, now); !room) return room.error();
  Peer peer;
  peer.name = name;
  peer.used = now;
  const std::string folder = "peers/" + own + "/";
  const Status made = make_all(
      participant_,
      {{&peer.alignment, names_.topic(folder + "alignment"), &kPoseWithCovarianceStamped, kStream},
       {&peer.confidence, names_.topic(folder + "confidence"), &kFloat, kStream},
       {&peer.landmarks, names_.topic(folder + "landmarks"), &kPointCloud, kMap}});
  if (!made) return made.error();
  return &peers_.emplace(own, std::move(peer)).first->second;
}

Status RobotTopics::tell_motion(const Motion& motion) const {
  nav_msgs_msg_dds__Odometry_ odometry = {};
  const std::string odom = names_.odom();
  const std::string base = names_.base();
  odometry.header = to_header(motion.system_ns, odom);
  odometry.child_frame_id = to_text(base);
  odometry.pose.pose = to_pose(motion.T_odom_base);
  put_covariance(motion.odom_covariance, odometry.pose.covariance);
  odometry.twist.twist.linear = {motion.velocity[0], motion.velocity[1], 0.0};
  odometry.twist.twist.angular = {0.0, 0.0, motion.velocity[2]};
  put_covariance(motion.velocity_covariance, odometry.twist.covariance);
  if (const Status written = odom_.write(&odometry); !written) return written;
  return write_pose(pose_, motion.system_ns, names_.map(), motion.T_map_base,
                    motion.map_covariance);
}

Status RobotTopics::tell_landmarks(std::int64_t system_ns, const Rows& rows) const {
  return write_cloud(landmarks_, system_ns, names_.map(), rows);
}

Status RobotTopics::tell_alignment(std::int64_t system_ns, const tools::AlignmentLine& line) {
  const auto told = peer(line.name);
  if (!told) return told.error();
  if (line.pose && line.variance) {
    const auto& [xx, yy, tt] = *line.variance;
    const Status written = write_pose((*told)->alignment, system_ns, names_.map(),
                                      pose_of(*line.pose), {xx, 0, 0, yy, 0, tt});
    if (!written) return written;
  }
  if (!line.confidence) return {};
  const std_msgs_msg_dds__Float32_ message = {static_cast<float>(*line.confidence)};
  return (*told)->confidence.write(&message);
}

Status RobotTopics::tell_peer_landmarks(const std::string& name, std::int64_t system_ns,
                                        const Rows& rows) {
  const auto told = peer(name);
  if (!told) return told.error();
  return write_cloud((*told)->landmarks, system_ns, names_.map_of(name), rows);
}

}  // namespace zenith::ros2
