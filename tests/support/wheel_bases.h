#pragma once
// Bases that exist in memory only, one for each codec and quantity: which frames they send when
// their wheels have turned so far, and the configuration that reads them. Wheels, nodes and bytes
// are asymmetric, so that a mixed-up one shows.

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/dbc.h"
#include "drivers/odometry/wheel_codec_config.h"

namespace zenith {

// Travel and speed of the robot's wheels, forward positive.
struct BaseMotion {
  Time stamp;
  double left_m = 0.0;
  double right_m = 0.0;
  double left_mps = 0.0;
  double right_mps = 0.0;
};

struct WheelBase {
  std::string name;
  WheelCodecConfig config = {};
  bool velocity = false;
  double wrap_m = 0.0;        // its counters wrap after this travel; 0: they do not
  double resolution_m = 0.0;  // of a position
  std::function<std::vector<CanFrame>(const BaseMotion&)> send = {};
};

inline constexpr const char* kWheelBasesDbc = R"(
BO_ 2566855178 ODOMETER: 8 BASE
 SG_ ODO_L : 0|32@1+ (0.0005,0) [0|0] "m" PC
 SG_ ODO_R : 32|32@1+ (0.0005,0) [0|0] "m" PC
BO_ 300 SPEED: 8 BASE
 SG_ SPEED_L : 22|15@0+ (0.01,-67.67) [0|0] "km/h" PC
 SG_ SPEED_R : 6|15@0+ (0.01,-67.67) [0|0] "km/h" PC
BO_ 301 TURNS_L: 8 BASE
 SG_ TURNS_L : 15|32@0- (1,0) [0|0] "turns" PC
BO_ 302 TURNS_R: 8 BASE
 SG_ TURNS_R : 24|32@1- (1,0) [0|0] "turns" PC
SIG_VALTYPE_ 301 TURNS_L : 1;
SIG_VALTYPE_ 302 TURNS_R : 1;
)";

namespace wheel_bases {

inline constexpr double kWrap32 = 4294967296.0;

// The low 32 bits, as a counter holds them.
inline std::uint32_t count_of(double units) {
  return static_cast<std::uint32_t>(std::llround(units));
}
inline std::int32_t signed_count_of(double units) {
  return static_cast<std::int32_t>(count_of(units));
}

inline WheelBase agilex() {
  WheelBase base = {.name = "agilex_v2", .wrap_m = 0.001 * kWrap32, .resolution_m = 0.001};
  base.send = [](const BaseMotion& m) {
    return std::vector<CanFrame>{
        agilex_v2::encode_motion(m.stamp, {0.5 * (m.left_mps + m.right_mps)}),
        agilex_v2::encode_odometer(
            m.stamp, {signed_count_of(1000.0 * m.left_m), signed_count_of(1000.0 * m.right_m)})};
  };
  return base;
}

// The right motor is mounted the other way round.
inline WheelBase odrive(WheelQuantity quantity) {
  WheelBase base = {.name = "odrive", .resolution_m = 0.001};
  base.velocity = quantity == WheelQuantity::kVelocity;
  base.config.kind = WheelCodecKind::kOdrive;
  base.config.invert_right = true;
  base.config.geometry = {.wheel_radius_m = 0.085, .gear_ratio = 2.0};
  base.config.odrive = {.left_node = 5, .right_node = 3, .quantity = quantity};
  const double turn_m = base.config.geometry.metres_per_motor_turn();
  base.send = [turn_m](const BaseMotion& m) {
    const auto turns = [turn_m](double metres) { return static_cast<float>(metres / turn_m); };
    return std::vector<CanFrame>{
        odrive::encode_heartbeat(m.stamp, 5, {0, 8}),
        odrive::encode_estimates(m.stamp, 5, {turns(m.left_m), turns(m.left_mps)}),
        odrive::encode_estimates(m.stamp, 3, {-turns(m.right_m), -turns(m.right_mps)})};
  };
  return base;
}

inline WheelBase vesc(WheelQuantity quantity) {
  WheelBase base = {.name = "vesc"};
  base.velocity = quantity == WheelQuantity::kVelocity;
  base.config.kind = WheelCodecKind::kVesc;
  base.config.swap_wheels = true;
  base.config.geometry = {.wheel_radius_m = 0.1, .gear_ratio = 5.0};
  base.config.vesc = {.left_id = 27,
                      .right_id = 4,
                      .quantity = quantity,
                      .counts_per_turn = 90.0,
                      .pole_pairs = 15.0};
  const double turn_m = base.config.geometry.metres_per_motor_turn();
  base.resolution_m = turn_m / 90.0;
  base.wrap_m = base.velocity ? 0.0 : base.resolution_m * kWrap32;
  base.send = [turn_m](const BaseMotion& m) {
    const auto counts = [turn_m](double metres) { return signed_count_of(90.0 * metres / turn_m); };
    const auto erpm = [turn_m](double mps) { return signed_count_of(60.0 * 15.0 * mps / turn_m); };
    return std::vector<CanFrame>{vesc::encode_status1(m.stamp, 4, {erpm(m.left_mps)}),
                                 vesc::encode_status5(m.stamp, 4, {counts(m.left_m)}),
                                 vesc::encode_status1(m.stamp, 27, {erpm(m.right_mps)}),
                                 vesc::encode_status5(m.stamp, 27, {counts(m.right_m)})};
  };
  return base;
}

// Both wheels in one PDO; velocities in tenths of rpm.
inline WheelBase canopen(WheelQuantity quantity) {
  WheelBase base = {.name = "canopen"};
  base.velocity = quantity == WheelQuantity::kVelocity;
  base.config.kind = WheelCodecKind::kCanopen;
  base.config.geometry = {.wheel_radius_m = 0.125, .gear_ratio = 10.0};
  const double units_per_turn = base.velocity ? 600.0 : 2048.0;
  base.config.canopen = {.left = {.cob_id = 0x285, .byte_offset = 4},
                         .right = {.cob_id = 0x285},
                         .quantity = quantity,
                         .units_per_turn = units_per_turn};
  base.resolution_m = base.config.geometry.metres_per_motor_turn() / units_per_turn;
  base.wrap_m = base.velocity ? 0.0 : base.resolution_m * kWrap32;
  base.send = [config = base.config.canopen, velocity = base.velocity,
               unit = base.resolution_m](const BaseMotion& m) {
    CanFrame frame;
    frame.stamp = m.stamp;
    const auto units = [unit](double value) { return signed_count_of(value / unit); };
    canopen::encode_mapped(frame, config.left, units(velocity ? m.left_mps : m.left_m));
    canopen::encode_mapped(frame, config.right, units(velocity ? m.right_mps : m.right_m));
    return std::vector<CanFrame>{frame};
  };
  return base;
}

inline DbcSignal dbc_signal(const char* name) {
  const auto file = parse_dbc(kWheelBasesDbc, "bases.dbc");
  const auto signal = file.ok() ? find_signal(*file, name) : Result<DbcEntry>(file.error());
  return signal.ok() ? signal->signal : DbcSignal{};
}

inline WheelBase dbc(const std::string& file, WheelQuantity quantity, const std::string& signals,
                     double metres_per_unit) {
  WheelBase base = {.name = "dbc_" + signals};
  base.velocity = quantity == WheelQuantity::kVelocity;
  base.config.kind = WheelCodecKind::kDbc;
  base.config.dbc = {file, signals + "_L", signals + "_R", quantity, metres_per_unit};
  const DbcSignal left = dbc_signal(base.config.dbc.left_signal.c_str());
  const DbcSignal right = dbc_signal(base.config.dbc.right_signal.c_str());
  const bool counter = !base.velocity && left.value == DbcValue::kUnsigned;
  base.resolution_m = counter ? left.scale * metres_per_unit : 0.001;
  base.wrap_m = counter ? base.resolution_m * kWrap32 : 0.0;
  base.send = [=, velocity = base.velocity, unit = base.resolution_m](const BaseMotion& m) {
    std::vector<CanFrame> frames(left.id == right.id ? 1 : 2);
    for (CanFrame& frame : frames) frame.stamp = m.stamp;
    const auto put = [&](const DbcSignal& signal, double metres, double mps, CanFrame& frame) {
      encode_signal(signal, (velocity ? mps : metres) / metres_per_unit, frame);
      if (counter) write_raw(signal, count_of(metres / unit), frame);
    };
    put(left, m.left_m, m.left_mps, frames.front());
    put(right, m.right_m, m.right_mps, frames.back());
    return frames;
  };
  return base;
}

}  // namespace wheel_bases

// `dbc_file` holds kWheelBasesDbc; it need not exist before a decoder is made.
inline std::vector<WheelBase> all_wheel_bases(const std::string& dbc_file) {
  constexpr auto kPosition = WheelQuantity::kPosition;
  constexpr auto kVelocity = WheelQuantity::kVelocity;
  std::vector<WheelBase> bases = {
      wheel_bases::agilex(),
      wheel_bases::odrive(kPosition),
      wheel_bases::odrive(kVelocity),
      wheel_bases::vesc(kPosition),
      wheel_bases::vesc(kVelocity),
      wheel_bases::canopen(kPosition),
      wheel_bases::canopen(kVelocity),
      wheel_bases::dbc(dbc_file, kPosition, "ODO", 1.0),
      wheel_bases::dbc(dbc_file, kPosition, "TURNS", 0.5),
      wheel_bases::dbc(dbc_file, kVelocity, "SPEED", 1.0 / 3.6),
  };
  for (WheelBase& base : bases) base.name += base.velocity ? "_velocity" : "_position";
  return bases;
}

}  // namespace zenith
