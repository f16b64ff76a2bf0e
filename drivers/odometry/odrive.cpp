#include "drivers/odometry/odrive.h"

#include "drivers/odometry/can_bytes.h"

namespace zenith::odrive {
namespace {

constexpr std::uint32_t kHeartbeat = 0x001;
constexpr std::uint32_t kEstimates = 0x009;
constexpr std::uint8_t kHeartbeatLength = 5;
constexpr std::uint8_t kEstimatesLength = 8;

constexpr CanId id_for(std::uint32_t node, std::uint32_t command) {
  return {node << 5u | command};
}

CanFrame frame_with(Time stamp, CanId id) {
  CanFrame frame;
  frame.stamp = stamp;
  frame.id = id.id;
  frame.length = 8;
  return frame;
}

}  // namespace

std::optional<Estimates> decode_estimates(const CanFrame& frame, std::uint32_t node) {
  if (id_of(frame) != id_for(node, kEstimates) || frame.length < kEstimatesLength) return {};
  return Estimates{read_little_endian_float(frame, 0), read_little_endian_float(frame, 4)};
}

std::optional<Heartbeat> decode_heartbeat(const CanFrame& frame, std::uint32_t node) {
  if (id_of(frame) != id_for(node, kHeartbeat) || frame.length < kHeartbeatLength) return {};
  return Heartbeat{read_little_endian(frame, 0, 4), frame.data[4]};
}

CanFrame encode_estimates(Time stamp, std::uint32_t node, const Estimates& estimates) {
  CanFrame frame = frame_with(stamp, id_for(node, kEstimates));
  write_little_endian_float(frame, 0, estimates.position_turns);
  write_little_endian_float(frame, 4, estimates.velocity_turns_per_s);
  return frame;
}

CanFrame encode_heartbeat(Time stamp, std::uint32_t node, const Heartbeat& heartbeat) {
  CanFrame frame = frame_with(stamp, id_for(node, kHeartbeat));
  write_little_endian(frame, 0, 4, heartbeat.axis_error);
  frame.data[4] = heartbeat.axis_state;
  return frame;
}

WheelNews Codec::read(const CanFrame& frame) const {
  WheelNews news;
  const bool left = id_of(frame) == id_for(config.left_node, frame.id & 0x1FU);
  const bool right = id_of(frame) == id_for(config.right_node, frame.id & 0x1FU);
  if (!left && !right) return news;
  const std::uint32_t node = left ? config.left_node : config.right_node;
  const std::uint32_t command = frame.id & 0x1FU;
  news.use = FrameUse::kNoTravel;
  if (command == kHeartbeat) {
    const auto heartbeat = decode_heartbeat(frame, node);
    if (!heartbeat) news.use = FrameUse::kTooShort;
    if (heartbeat) (left ? news.left_error : news.right_error) = heartbeat->axis_error;
  }
  if (command != kEstimates) return news;
  const auto estimates = decode_estimates(frame, node);
  news.use = estimates ? FrameUse::kReading : FrameUse::kTooShort;
  if (!estimates) return news;
  const bool position = config.quantity == WheelQuantity::kPosition;
  (left ? news.left : news.right) =
      WheelReading{.value = position ? estimates->position_turns : estimates->velocity_turns_per_s};
  return news;
}

WheelScales Codec::scales(const WheelGeometry& geometry) const {
  const bool position = config.quantity == WheelQuantity::kPosition;
  const WheelScale scale = {.kind = position ? WheelKind::kPosition : WheelKind::kVelocity,
                            .metres_per_unit = geometry.metres_per_motor_turn()};
  return {scale, scale};
}

CanIds Codec::ids() const {
  CanIds ids;
  for (const std::uint32_t node : {config.left_node, config.right_node}) {
    ids.push_back(id_for(node, kEstimates));
    ids.push_back(id_for(node, kHeartbeat));
  }
  return ids;
}

}  // namespace zenith::odrive
