#pragma once
// Which base, and how it is built: plain data with defaults, one table of its keys for files and
// reference pages, and the decoder that comes of it.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "drivers/odometry/canopen.h"
#include "drivers/odometry/dbc_codec.h"
#include "drivers/odometry/odrive.h"
#include "drivers/odometry/vesc.h"
#include "drivers/odometry/wheel_accumulator.h"
#include "drivers/odometry/wheel_codec.h"
#include "drivers/odometry/wheel_decoder.h"
#include "platform/base/result.h"

namespace zenith {

// In files: "agilex_v2", "odrive", "vesc", "canopen", "dbc".
enum class WheelCodecKind { kAgilexV2, kOdrive, kVesc, kCanopen, kDbc };

struct WheelCodecConfig {
  WheelCodecKind kind = WheelCodecKind::kAgilexV2;
  bool swap_wheels = false;     // what the base calls left is the robot's right wheel
  bool invert_left = false;     // the robot's left wheel counts down when driving forward
  bool invert_right = false;    // usual where both motors are mounted alike
  double latency_s = 0.0;       // the wheels were where a frame says so long before its stamp
  WheelGeometry geometry = {};  // odrive, vesc, canopen
  WheelLimits limits = {};
  odrive::Config odrive = {};
  vesc::Config vesc = {};
  canopen::Config canopen = {};
  dbc::Config dbc = {};
};

std::string_view wheel_codec_name(WheelCodecKind kind);
std::optional<WheelCodecKind> find_wheel_codec(std::string_view name);
// "agilex_v2, odrive, ...", for messages.
std::string wheel_codec_names();

// What the base's readings are.
WheelQuantity wheel_quantity(const WheelCodecConfig& config);
// "position" and "velocity" in files.
std::string_view wheel_quantity_name(WheelQuantity quantity);
std::optional<WheelQuantity> find_wheel_quantity(std::string_view name);

// One key of the configuration but for the kind itself.
struct WheelCodecField {
  using Config = WheelCodecConfig;

  std::string_view key;  // "wheel_radius_m", or within a section: "odrive.left_node"
  std::string_view unit;
  double min = 0.0;  // of numbers
  double max = 0.0;
  std::string_view text;
  std::variant<double* (*)(Config&), std::uint32_t* (*)(Config&), bool* (*)(Config&),
               std::string* (*)(Config&), WheelQuantity* (*)(Config&)>
      at;

  // Whether a codec reads the key.
  bool belongs_to(WheelCodecKind kind) const;
};

std::span<const WheelCodecField> wheel_codec_fields();

// For start-up: allocates, and reads the DBC file when there is one. The error tells all that is
// wrong at once, a line for each, with the keys as in the table.
Result<WheelDecoder> make_wheel_decoder(const WheelCodecConfig& config);

}  // namespace zenith
