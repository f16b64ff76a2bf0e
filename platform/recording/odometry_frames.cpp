#include "platform/recording/odometry_frames.h"

#include <cmath>
#include <numbers>

namespace zenith {
namespace {

constexpr canopen::Mapping kLeft = {.cob_id = 0x181, .byte_offset = 0};
constexpr canopen::Mapping kRight = {.cob_id = 0x181, .byte_offset = 4};
constexpr double kUnitsPerMetre = 1e6;

std::int32_t units_of(double metres) {
  // Modulo 2^32, as the counter that it stands for.
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(std::llround(metres * kUnitsPerMetre)));
}

}  // namespace

WheelCodecConfig codec_of_samples(const WheelLimits& limits) {
  WheelCodecConfig config;
  config.kind = WheelCodecKind::kCanopen;
  config.limits = limits;
  config.canopen.left = kLeft;
  config.canopen.right = kRight;
  config.canopen.units_per_turn =
      kUnitsPerMetre * 2.0 * std::numbers::pi * config.geometry.wheel_radius_m;
  return config;
}

CanFrame frame_of_sample(const WheelSample& sample) {
  CanFrame frame;
  frame.stamp = sample.stamp;
  canopen::encode_mapped(frame, kLeft, units_of(sample.left_m));
  canopen::encode_mapped(frame, kRight, units_of(sample.right_m));
  return frame;
}

}  // namespace zenith
