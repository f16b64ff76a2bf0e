#include "drivers/odometry/vesc.h"

#include "drivers/odometry/can_bytes.h"

namespace zenith::vesc {
namespace {

constexpr std::uint32_t kStatus1 = 0x09;
constexpr std::uint32_t kStatus5 = 0x1B;
constexpr std::uint8_t kStatus1Length = 8;
constexpr std::uint8_t kStatus5Length = 6;

constexpr CanId id_for(std::uint32_t packet, std::uint32_t controller) {
  return {packet << 8u | controller, true};
}

CanFrame frame_with(Time stamp, CanId id, std::int32_t first) {
  CanFrame frame;
  frame.stamp = stamp;
  frame.id = id.id;
  frame.extended = id.extended;
  frame.length = 8;
  write_big_endian(frame, 0, 4, static_cast<std::uint32_t>(first));
  return frame;
}

}  // namespace

std::optional<Status1> decode_status1(const CanFrame& frame, std::uint32_t controller) {
  if (id_of(frame) != id_for(kStatus1, controller) || frame.length < kStatus1Length) return {};
  return Status1{static_cast<std::int32_t>(read_big_endian(frame, 0, 4)),
                 read_big_endian_i16(frame, 4, 0.1), read_big_endian_i16(frame, 6, 0.001)};
}

std::optional<Status5> decode_status5(const CanFrame& frame, std::uint32_t controller) {
  if (id_of(frame) != id_for(kStatus5, controller) || frame.length < kStatus5Length) return {};
  return Status5{static_cast<std::int32_t>(read_big_endian(frame, 0, 4)),
                 read_big_endian_i16(frame, 4, 0.1)};
}

CanFrame encode_status1(Time stamp, std::uint32_t controller, const Status1& status) {
  CanFrame frame = frame_with(stamp, id_for(kStatus1, controller), status.erpm);
  write_big_endian_i16(frame, 4, 0.1, status.current_a);
  write_big_endian_i16(frame, 6, 0.001, status.duty);
  return frame;
}

CanFrame encode_status5(Time stamp, std::uint32_t controller, const Status5& status) {
  CanFrame frame = frame_with(stamp, id_for(kStatus5, controller), status.tachometer);
  write_big_endian_i16(frame, 4, 0.1, status.input_voltage_v);
  return frame;
}

WheelNews Codec::read(const CanFrame& frame) const {
  WheelNews news;
  const std::uint32_t packet = frame.id >> 8u;
  const bool left = id_of(frame) == id_for(packet, config.left_id);
  const bool right = id_of(frame) == id_for(packet, config.right_id);
  if (!left && !right) return news;
  const std::uint32_t controller = left ? config.left_id : config.right_id;
  const bool position = config.quantity == WheelQuantity::kPosition;
  news.use = FrameUse::kNoTravel;
  if (packet != (position ? kStatus5 : kStatus1)) return news;
  news.use = FrameUse::kTooShort;
  WheelReading reading;
  if (position) {
    const auto status = decode_status5(frame, controller);
    if (!status) return news;
    reading.count = static_cast<std::uint32_t>(status->tachometer);
  } else {
    const auto status = decode_status1(frame, controller);
    if (!status) return news;
    reading.value = status->erpm;
  }
  news.use = FrameUse::kReading;
  (left ? news.left : news.right) = reading;
  return news;
}

WheelScales Codec::scales(const WheelGeometry& geometry) const {
  const double turn_m = geometry.metres_per_motor_turn();
  WheelScale scale = {WheelKind::kCounter, 32, turn_m / config.counts_per_turn};
  if (config.quantity == WheelQuantity::kVelocity) {
    scale = {.kind = WheelKind::kVelocity, .metres_per_unit = turn_m / (60.0 * config.pole_pairs)};
  }
  return {scale, scale};
}

CanIds Codec::ids() const {
  const std::uint32_t packet = config.quantity == WheelQuantity::kPosition ? kStatus5 : kStatus1;
  CanIds ids;
  ids.push_back(id_for(packet, config.left_id));
  ids.push_back(id_for(packet, config.right_id));
  return ids;
}

}  // namespace zenith::vesc
