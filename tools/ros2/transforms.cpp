#include "tools/ros2/transforms.h"

#include <zenith_ros2_idl/tf2_msgs.h>

#include "tools/ros2/convert.h"

namespace zenith::ros2 {
namespace {

Status write(const Writer& writer, const std::vector<FrameTransform>& transforms) {
  std::vector<geometry_msgs_msg_dds__TransformStamped_> list;
  for (const FrameTransform& t : transforms) {
    const Pose2& pose = t.T_parent_child;
    list.push_back({to_header(t.system_ns, t.parent),
                    to_text(t.child),
                    {{pose.x_m, pose.y_m, 0.0}, to_quaternion(pose.theta_rad)}});
  }
  tf2_msgs_msg_dds__TFMessage_ message = {};
  message.transforms = to_sequence<decltype(message.transforms)>(list);
  return writer.write(&message);
}

}  // namespace

Result<Transforms> Transforms::make(const Participant& participant) {
  auto moving = Writer::make(participant, "rt/tf", kTransforms, {100, false});
  if (!moving) return moving.error();
  auto fixed = Writer::make(participant, "rt/tf_static", kTransforms, {1, true});
  if (!fixed) return fixed.error();
  Transforms out;
  out.moving_ = std::move(*moving);
  out.fixed_ = std::move(*fixed);
  return out;
}

Status Transforms::send(const std::vector<FrameTransform>& moving) const {
  return write(moving_, moving);
}

Status Transforms::send_static(const std::vector<FrameTransform>& fixed) const {
  return write(fixed_, fixed);
}

}  // namespace zenith::ros2
