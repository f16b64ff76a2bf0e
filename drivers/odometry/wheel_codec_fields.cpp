#include <algorithm>
#include <array>

#include "drivers/odometry/wheel_codec_config.h"

namespace zenith {
namespace {

using C = WheelCodecConfig;

constexpr std::array kKinds = {WheelCodecKind::kAgilexV2, WheelCodecKind::kOdrive,
                               WheelCodecKind::kVesc, WheelCodecKind::kCanopen,
                               WheelCodecKind::kDbc};

constexpr std::array kFields = {
    WheelCodecField{"swap_wheels", "", 0, 0, "what the base calls left is the right wheel",
                    [](C& c) { return &c.swap_wheels; }},
    WheelCodecField{"invert_left", "", 0, 0, "the left wheel counts down when driving forward",
                    [](C& c) { return &c.invert_left; }},
    WheelCodecField{"invert_right", "", 0, 0, "the right wheel counts down when driving forward",
                    [](C& c) { return &c.invert_right; }},
    WheelCodecField{"latency_s", "s", -1.5, 1.5,
                    "a frame tells where the wheels were so long before its stamp",
                    [](C& c) { return &c.latency_s; }},
    WheelCodecField{"max_wheel_speed_mps", "m/s", 0.01, 50,
                    "a faster step is a restart of the base",
                    [](C& c) { return &c.limits.max_speed_mps; }},
    WheelCodecField{"max_gap_s", "s", 0.05, 60,
                    "a longer silence allows no longer step than this one",
                    [](C& c) { return &c.limits.max_gap_s; }},
    WheelCodecField{"max_velocity_gap_s", "s", 0.01, 2, "a velocity holds no longer than this",
                    [](C& c) { return &c.limits.max_velocity_gap_s; }},
    WheelCodecField{"wheel_radius_m", "m", 0.005, 1, "odrive, vesc, canopen: radius of the wheels",
                    [](C& c) { return &c.geometry.wheel_radius_m; }},
    WheelCodecField{"gear_ratio", "", 0.01, 1000, "motor's turns in one turn of the wheel",
                    [](C& c) { return &c.geometry.gear_ratio; }},

    WheelCodecField{"odrive.left_node", "", 0, odrive::kMaxNode, "node of the left axis",
                    [](C& c) { return &c.odrive.left_node; }},
    WheelCodecField{"odrive.right_node", "", 0, odrive::kMaxNode, "node of the right axis",
                    [](C& c) { return &c.odrive.right_node; }},
    WheelCodecField{"odrive.quantity", "", 0, 0, "position or velocity",
                    [](C& c) { return &c.odrive.quantity; }},

    WheelCodecField{"vesc.left_id", "", 0, vesc::kMaxController, "controller of the left motor",
                    [](C& c) { return &c.vesc.left_id; }},
    WheelCodecField{"vesc.right_id", "", 0, vesc::kMaxController, "controller of the right motor",
                    [](C& c) { return &c.vesc.right_id; }},
    WheelCodecField{"vesc.quantity", "", 0, 0, "position (status 5) or velocity (status 1)",
                    [](C& c) { return &c.vesc.quantity; }},
    WheelCodecField{"vesc.counts_per_turn", "", 1, 1e6, "tachometer's counts per motor turn",
                    [](C& c) { return &c.vesc.counts_per_turn; }},
    WheelCodecField{"vesc.pole_pairs", "", 1, 100, "of the motors, for velocities",
                    [](C& c) { return &c.vesc.pole_pairs; }},

    WheelCodecField{"canopen.left_cob_id", "", 1, 0x7FF, "PDO with the left wheel",
                    [](C& c) { return &c.canopen.left.cob_id; }},
    WheelCodecField{"canopen.left_byte_offset", "", 0, 6, "where it begins in the PDO",
                    [](C& c) { return &c.canopen.left.byte_offset; }},
    WheelCodecField{"canopen.left_byte_length", "", 2, 4, "2 or 4",
                    [](C& c) { return &c.canopen.left.byte_length; }},
    WheelCodecField{"canopen.left_signed", "", 0, 0, "two's complement",
                    [](C& c) { return &c.canopen.left.is_signed; }},
    WheelCodecField{"canopen.right_cob_id", "", 1, 0x7FF, "PDO with the right wheel",
                    [](C& c) { return &c.canopen.right.cob_id; }},
    WheelCodecField{"canopen.right_byte_offset", "", 0, 6, "where it begins in the PDO",
                    [](C& c) { return &c.canopen.right.byte_offset; }},
    WheelCodecField{"canopen.right_byte_length", "", 2, 4, "2 or 4",
                    [](C& c) { return &c.canopen.right.byte_length; }},
    WheelCodecField{"canopen.right_signed", "", 0, 0, "two's complement",
                    [](C& c) { return &c.canopen.right.is_signed; }},
    WheelCodecField{"canopen.quantity", "", 0, 0, "position (0x6064) or velocity (0x606C)",
                    [](C& c) { return &c.canopen.quantity; }},
    WheelCodecField{"canopen.units_per_turn", "", 1e-3, 1e9,
                    "position units per motor turn; velocity reading at one turn per second",
                    [](C& c) { return &c.canopen.units_per_turn; }},

    WheelCodecField{"dbc.file", "", 0, 0, "the base's DBC file", [](C& c) { return &c.dbc.file; }},
    WheelCodecField{"dbc.left_signal", "", 0, 0, "SIGNAL or MESSAGE.SIGNAL",
                    [](C& c) { return &c.dbc.left_signal; }},
    WheelCodecField{"dbc.right_signal", "", 0, 0, "SIGNAL or MESSAGE.SIGNAL",
                    [](C& c) { return &c.dbc.right_signal; }},
    WheelCodecField{"dbc.quantity", "", 0, 0, "position or velocity",
                    [](C& c) { return &c.dbc.quantity; }},
    WheelCodecField{"dbc.metres_per_unit", "", 1e-9, 1e3,
                    "from the signals' unit to m or m/s: 0.277778 for km/h",
                    [](C& c) { return &c.dbc.metres_per_unit; }},
};

}  // namespace

std::span<const WheelCodecField> wheel_codec_fields() {
  return kFields;
}

bool WheelCodecField::belongs_to(WheelCodecKind kind) const {
  if (key == "wheel_radius_m" || key == "gear_ratio") {
    return kind != WheelCodecKind::kAgilexV2 && kind != WheelCodecKind::kDbc;
  }
  const std::size_t dot = key.find('.');
  return dot == std::string_view::npos || key.substr(0, dot) == wheel_codec_name(kind);
}

std::string_view wheel_codec_name(WheelCodecKind kind) {
  switch (kind) {
    case WheelCodecKind::kAgilexV2:
      return "agilex_v2";
    case WheelCodecKind::kOdrive:
      return "odrive";
    case WheelCodecKind::kVesc:
      return "vesc";
    case WheelCodecKind::kCanopen:
      return "canopen";
    case WheelCodecKind::kDbc:
      return "dbc";
  }
  return "";
}

std::optional<WheelCodecKind> find_wheel_codec(std::string_view name) {
  for (const WheelCodecKind kind : kKinds) {
    if (name == wheel_codec_name(kind)) return kind;
  }
  return std::nullopt;
}

std::string wheel_codec_names() {
  std::string names;
  for (const WheelCodecKind kind : kKinds) {
    names += (names.empty() ? "" : ", ") + std::string(wheel_codec_name(kind));
  }
  return names;
}

std::string_view wheel_quantity_name(WheelQuantity quantity) {
  return quantity == WheelQuantity::kPosition ? "position" : "velocity";
}

std::optional<WheelQuantity> find_wheel_quantity(std::string_view name) {
  for (const WheelQuantity quantity : {WheelQuantity::kPosition, WheelQuantity::kVelocity}) {
    if (name == wheel_quantity_name(quantity)) return quantity;
  }
  return std::nullopt;
}

}  // namespace zenith
