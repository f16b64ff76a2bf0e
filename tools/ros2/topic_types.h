#pragma once
// The message types that the bridge publishes.

#include <span>
#include <string_view>

struct dds_topic_descriptor;

namespace zenith::ros2 {

struct TopicType {
  std::string_view name;  // as ROS 2 shows it: "nav_msgs/msg/Odometry"
  // ROS 2's hash of the type's description (REP-2016), which participants since Iron tell of their
  // topics. A test computes it from idl/ once more.
  std::string_view hash;
  const dds_topic_descriptor* descriptor;
};

extern const TopicType kOdometry;
extern const TopicType kPoseWithCovarianceStamped;
extern const TopicType kTransforms;
extern const TopicType kPointCloud;
extern const TopicType kFloat;
extern const TopicType kDiagnostics;

std::span<const TopicType* const> topic_types();

}  // namespace zenith::ros2
