#pragma once
// Landmarks of one map as ROS 2's point cloud.
//
//   x y z         float32, metres, in the map's frame
//   id            uint32
//   observations  uint32
//   sigma_xy      float32, metres: one standard deviation along the ellipse's longer axis
//   sigma_z       float32, metres

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <zenith_ros2_idl/sensor_msgs.h>

#include "tools/view/robot_state.h"

namespace zenith::ros2 {

class LandmarkCloud {
 public:
  static constexpr std::uint32_t kPointBytes = 28;

  LandmarkCloud(std::int64_t system_ns, std::string frame,
                const std::vector<tools::RobotState::Row>& rows);
  LandmarkCloud(const LandmarkCloud&) = delete;
  LandmarkCloud& operator=(const LandmarkCloud&) = delete;

  // Valid as long as this object.
  const sensor_msgs_msg_dds__PointCloud2_& message() const { return message_; }

 private:
  std::string frame_;
  std::vector<sensor_msgs_msg_dds__PointField_> fields_;
  std::vector<std::uint8_t> data_;
  sensor_msgs_msg_dds__PointCloud2_ message_ = {};
};

}  // namespace zenith::ros2
