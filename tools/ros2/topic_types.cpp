#include "tools/ros2/topic_types.h"

#include <array>

#include <zenith_ros2_idl/diagnostic_msgs.h>
#include <zenith_ros2_idl/nav_msgs.h>
#include <zenith_ros2_idl/sensor_msgs.h>
#include <zenith_ros2_idl/tf2_msgs.h>

namespace zenith::ros2 {

const TopicType kOdometry = {
    "nav_msgs/msg/Odometry",
    "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    &nav_msgs_msg_dds__Odometry__desc};
const TopicType kPoseWithCovarianceStamped = {
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e",
    &geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc};
const TopicType kTransforms = {
    "tf2_msgs/msg/TFMessage",
    "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    &tf2_msgs_msg_dds__TFMessage__desc};
const TopicType kPointCloud = {
    "sensor_msgs/msg/PointCloud2",
    "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
    &sensor_msgs_msg_dds__PointCloud2__desc};
const TopicType kFloat = {"std_msgs/msg/Float32",
                          "RIHS01_7170d3d8f841f7be3172ce5f4f59f3a4d7f63b0447e8b33327601ad64d83d6e2",
                          &std_msgs_msg_dds__Float32__desc};
const TopicType kDiagnostics = {
    "diagnostic_msgs/msg/DiagnosticArray",
    "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    &diagnostic_msgs_msg_dds__DiagnosticArray__desc};

std::span<const TopicType* const> topic_types() {
  static constexpr std::array kAll = {
      &kOdometry, &kPoseWithCovarianceStamped, &kTransforms, &kPointCloud, &kFloat, &kDiagnostics};
  return kAll;
}

}  // namespace zenith::ros2
