#include "drivers/odometry/agilex_v2.h"

#include <utility>

#include "drivers/odometry/can_bytes.h"

namespace zenith::agilex_v2 {
namespace {

constexpr double kMotionUnit = 0.001;
constexpr double kMetresPerCount = 0.001;
constexpr std::uint8_t kLength = 8;

bool has_layout(const CanFrame& frame, std::uint32_t id) {
  return !frame.extended && frame.id == id && frame.length >= kLength;
}

CanFrame frame_with(Time stamp, std::uint32_t id) {
  CanFrame frame;
  frame.stamp = stamp;
  frame.id = id;
  frame.length = kLength;
  return frame;
}

}  // namespace

std::optional<Odometer> decode_odometer(const CanFrame& frame) {
  if (!has_layout(frame, kOdometerId)) return std::nullopt;
  return Odometer{static_cast<std::int32_t>(read_big_endian(frame, 0, 4)),
                  static_cast<std::int32_t>(read_big_endian(frame, 4, 4))};
}

std::optional<Motion> decode_motion(const CanFrame& frame) {
  if (!has_layout(frame, kMotionId)) return std::nullopt;
  const auto value = [&frame](std::size_t at) {
    return read_big_endian_i16(frame, at, kMotionUnit);
  };
  return Motion{value(0), value(2), value(4), value(6)};
}

CanFrame encode_odometer(Time stamp, const Odometer& odometer) {
  CanFrame frame = frame_with(stamp, kOdometerId);
  write_big_endian(frame, 0, 4, static_cast<std::uint32_t>(odometer.left_mm));
  write_big_endian(frame, 4, 4, static_cast<std::uint32_t>(odometer.right_mm));
  return frame;
}

CanFrame encode_motion(Time stamp, const Motion& motion) {
  CanFrame frame = frame_with(stamp, kMotionId);
  write_big_endian_i16(frame, 0, kMotionUnit, motion.linear_mps);
  write_big_endian_i16(frame, 2, kMotionUnit, motion.angular_radps);
  write_big_endian_i16(frame, 4, kMotionUnit, motion.lateral_mps);
  write_big_endian_i16(frame, 6, kMotionUnit, motion.steering_rad);
  return frame;
}

WheelNews Codec::read(const CanFrame& frame) const {
  WheelNews news;
  const CanId id = id_of(frame);
  if (id == CanId{kMotionId}) news.use = FrameUse::kNoTravel;
  if (id != CanId{kOdometerId}) return news;
  const auto odometer = decode_odometer(frame);
  news.use = odometer ? FrameUse::kReading : FrameUse::kTooShort;
  if (!odometer) return news;
  news.left = WheelReading{.count = static_cast<std::uint32_t>(odometer->left_mm)};
  news.right = WheelReading{.count = static_cast<std::uint32_t>(odometer->right_mm)};
  if (swap_wheels) std::swap(news.left, news.right);
  return news;
}

WheelScales Codec::scales(const WheelGeometry&) const {
  const WheelScale scale = {WheelKind::kCounter, 32, kMetresPerCount};
  return {scale, scale};
}

CanIds Codec::ids() const {
  CanIds ids;
  ids.push_back({kOdometerId});
  return ids;
}

}  // namespace zenith::agilex_v2
