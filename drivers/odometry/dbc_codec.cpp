#include "drivers/odometry/dbc_codec.h"

namespace zenith::dbc {
namespace {

WheelReading read_signal(const DbcSignal& signal, const CanFrame& frame) {
  const std::uint64_t raw = read_raw(signal, frame);
  return {raw, physical_of(signal, raw)};
}

WheelScale scale_of(const DbcSignal& signal, WheelQuantity quantity, double metres_per_unit) {
  if (quantity == WheelQuantity::kVelocity) {
    return {.kind = WheelKind::kVelocity, .metres_per_unit = metres_per_unit};
  }
  const bool integer = signal.value == DbcValue::kUnsigned || signal.value == DbcValue::kSigned;
  if (!integer) return {.kind = WheelKind::kPosition, .metres_per_unit = metres_per_unit};
  return {WheelKind::kCounter, static_cast<int>(signal.bit_length), signal.scale * metres_per_unit};
}

}  // namespace

WheelNews Codec::read(const CanFrame& frame) const {
  WheelNews news;
  bool has_left = id_of(frame) == left.id;
  bool has_right = id_of(frame) == right.id;
  if (!has_left && !has_right) return news;
  news.use = FrameUse::kTooShort;
  if (has_left && frame.length < bytes_needed(left, left_when)) return news;
  if (has_right && frame.length < bytes_needed(right, right_when)) return news;
  has_left = has_left && holds(left_when, frame);
  has_right = has_right && holds(right_when, frame);
  news.use = has_left || has_right ? FrameUse::kReading : FrameUse::kNoTravel;
  if (has_left) news.left = read_signal(left, frame);
  if (has_right) news.right = read_signal(right, frame);
  return news;
}

WheelScales Codec::scales(const WheelGeometry&) const {
  return {scale_of(left, quantity, metres_per_unit), scale_of(right, quantity, metres_per_unit)};
}

CanIds Codec::ids() const {
  CanIds ids;
  ids.push_back(left.id);
  if (right.id != left.id) ids.push_back(right.id);
  return ids;
}

}  // namespace zenith::dbc
