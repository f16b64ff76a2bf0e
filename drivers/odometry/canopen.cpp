#include "drivers/odometry/canopen.h"

#include <algorithm>

#include "drivers/odometry/can_bytes.h"

namespace zenith::canopen {
namespace {

bool holds(const CanFrame& frame, const Mapping& mapping) {
  return frame.length >= mapping.byte_offset + mapping.byte_length;
}

WheelReading read_mapped(const CanFrame& frame, const Mapping& mapping) {
  const std::uint32_t raw = read_little_endian(frame, mapping.byte_offset, mapping.byte_length);
  double value = raw;
  if (mapping.is_signed) {
    value =
        mapping.byte_length == 2 ? static_cast<std::int16_t>(raw) : static_cast<std::int32_t>(raw);
  }
  return {raw, value};
}

WheelScale scale_of(const Mapping& mapping, WheelQuantity quantity, double metres_per_unit) {
  const bool position = quantity == WheelQuantity::kPosition;
  return {position ? WheelKind::kCounter : WheelKind::kVelocity,
          static_cast<int>(8 * mapping.byte_length), metres_per_unit};
}

}  // namespace

void encode_mapped(CanFrame& frame, const Mapping& mapping, std::int32_t value) {
  frame.id = mapping.cob_id;
  frame.extended = false;
  frame.length =
      std::max(frame.length, static_cast<std::uint8_t>(mapping.byte_offset + mapping.byte_length));
  write_little_endian(frame, mapping.byte_offset, mapping.byte_length,
                      static_cast<std::uint32_t>(value));
}

WheelNews Codec::read(const CanFrame& frame) const {
  WheelNews news;
  const bool left = id_of(frame) == CanId{config.left.cob_id};
  const bool right = id_of(frame) == CanId{config.right.cob_id};
  if (!left && !right) return news;
  news.use = FrameUse::kTooShort;
  if ((left && !holds(frame, config.left)) || (right && !holds(frame, config.right))) return news;
  news.use = FrameUse::kReading;
  if (left) news.left = read_mapped(frame, config.left);
  if (right) news.right = read_mapped(frame, config.right);
  return news;
}

WheelScales Codec::scales(const WheelGeometry& geometry) const {
  const double unit_m = geometry.metres_per_motor_turn() / config.units_per_turn;
  return {scale_of(config.left, config.quantity, unit_m),
          scale_of(config.right, config.quantity, unit_m)};
}

CanIds Codec::ids() const {
  CanIds ids;
  ids.push_back({config.left.cob_id});
  if (config.right.cob_id != config.left.cob_id) ids.push_back({config.right.cob_id});
  return ids;
}

}  // namespace zenith::canopen
