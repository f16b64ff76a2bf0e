#include "drivers/odometry/agilex_v2.h"

#include <algorithm>
#include <cmath>

namespace zenith::agilex_v2 {
namespace {

constexpr double kMotionUnit = 0.001;
constexpr std::uint8_t kLength = 8;

bool has_layout(const CanFrame& frame, std::uint32_t id) {
  return !frame.extended && frame.id == id && frame.length >= kLength;
}

std::uint32_t read_u32(const CanFrame& frame, std::size_t at) {
  return std::uint32_t{frame.data[at]} << 24u | std::uint32_t{frame.data[at + 1]} << 16u |
         std::uint32_t{frame.data[at + 2]} << 8u | std::uint32_t{frame.data[at + 3]};
}

void write_u32(CanFrame& frame, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(value >> (24u - 8u * i));
  }
}

double read_i16(const CanFrame& frame, std::size_t at) {
  const auto raw =
      static_cast<std::uint16_t>(std::uint32_t{frame.data[at]} << 8u | frame.data[at + 1]);
  return kMotionUnit * static_cast<std::int16_t>(raw);
}

void write_i16(CanFrame& frame, std::size_t at, double value) {
  const double steps = std::clamp(std::round(value / kMotionUnit), -32768.0, 32767.0);
  const auto raw = static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
  frame.data[at] = static_cast<std::uint8_t>(raw >> 8u);
  frame.data[at + 1] = static_cast<std::uint8_t>(raw);
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
  return Odometer{static_cast<std::int32_t>(read_u32(frame, 0)),
                  static_cast<std::int32_t>(read_u32(frame, 4))};
}

std::optional<Motion> decode_motion(const CanFrame& frame) {
  if (!has_layout(frame, kMotionId)) return std::nullopt;
  return Motion{read_i16(frame, 0), read_i16(frame, 2), read_i16(frame, 4), read_i16(frame, 6)};
}

CanFrame encode_odometer(Time stamp, const Odometer& odometer) {
  CanFrame frame = frame_with(stamp, kOdometerId);
  write_u32(frame, 0, static_cast<std::uint32_t>(odometer.left_mm));
  write_u32(frame, 4, static_cast<std::uint32_t>(odometer.right_mm));
  return frame;
}

CanFrame encode_motion(Time stamp, const Motion& motion) {
  CanFrame frame = frame_with(stamp, kMotionId);
  write_i16(frame, 0, motion.linear_mps);
  write_i16(frame, 2, motion.angular_radps);
  write_i16(frame, 4, motion.lateral_mps);
  write_i16(frame, 6, motion.steering_rad);
  return frame;
}

}  // namespace zenith::agilex_v2
