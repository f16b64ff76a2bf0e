#include "drivers/odometry/wheel_codec_config.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "drivers/odometry/dbc.h"

namespace zenith {
namespace {

constexpr std::uint32_t kMinCounterBits = 8;

// Collects what is wrong, a line for each.
class Problems {
 public:
  explicit Problems(WheelCodecKind kind) : prefix_("odometry of codec ") {
    prefix_ += wheel_codec_name(kind);
    prefix_ += ": ";
  }
  void add(const std::string& what) { text_ += (text_.empty() ? "" : "\n") + prefix_ + what; }
  bool any() const { return !text_.empty(); }
  Error error() const { return {text_}; }

 private:
  std::string prefix_;
  std::string text_;
};

void check_range(const WheelCodecField& field, double value, Problems& problems) {
  if (std::isfinite(value) && value >= field.min && value <= field.max) return;
  char text[160];
  std::snprintf(text, sizeof text, "%.*s is %.10g, expected %g .. %g",
                static_cast<int>(field.key.size()), field.key.data(), value, field.min, field.max);
  problems.add(text);
}

void check_ranges(WheelCodecConfig config, Problems& problems) {
  for (const WheelCodecField& field : wheel_codec_fields()) {
    if (!field.belongs_to(config.kind)) continue;
    if (const auto* real = std::get_if<double* (*)(WheelCodecConfig&)>(&field.at)) {
      check_range(field, *(*real)(config), problems);
    }
    if (const auto* whole = std::get_if<std::uint32_t* (*)(WheelCodecConfig&)>(&field.at)) {
      check_range(field, *(*whole)(config), problems);
    }
  }
}

void check_different(const char* what, std::uint32_t left, std::uint32_t right,
                     Problems& problems) {
  if (left != right) return;
  problems.add(std::string(what) + " is " + std::to_string(left) +
               " for both wheels, expected one of its own for each");
}

void check_mapping(const std::string& side, const canopen::Mapping& mapping, Problems& problems) {
  if (mapping.byte_length != 2 && mapping.byte_length != 4) {
    problems.add("canopen." + side + "_byte_length is " + std::to_string(mapping.byte_length) +
                 ", expected 2 or 4");
  }
  if (std::uint64_t{mapping.byte_offset} + mapping.byte_length > 8) {
    problems.add("canopen." + side + ": byte_offset + byte_length go beyond the 8 bytes of a PDO");
  }
}

void check_canopen(const canopen::Config& config, Problems& problems) {
  check_mapping("left", config.left, problems);
  check_mapping("right", config.right, problems);
  const canopen::Mapping& left = config.left;
  const canopen::Mapping& right = config.right;
  if (left.cob_id == right.cob_id && left.byte_offset < right.byte_offset + right.byte_length &&
      right.byte_offset < left.byte_offset + left.byte_length) {
    problems.add("canopen: both wheels are mapped to the same bytes of one PDO");
  }
}

std::optional<DbcEntry> take_signal(const DbcFile& file, const std::string& key,
                                    const std::string& name, WheelQuantity quantity,
                                    Problems& problems) {
  if (name.empty()) {
    problems.add(key + " is missing, expected SIGNAL or MESSAGE.SIGNAL");
    return std::nullopt;
  }
  const auto found = find_signal(file, name);
  if (!found.ok()) {
    problems.add(key + ": " + found.error().message);
    return std::nullopt;
  }
  const DbcSignal& signal = found->signal;
  const bool is_float = signal.value == DbcValue::kFloat32 || signal.value == DbcValue::kFloat64;
  if (quantity == WheelQuantity::kPosition && !is_float && signal.bit_length < kMinCounterBits) {
    problems.add(key + ": " + name + " has " + std::to_string(signal.bit_length) +
                 " bits, expected at least " + std::to_string(kMinCounterBits) +
                 " in a position: fewer wrap too often to be followed");
  }
  return *found;
}

// Of frames that hold both.
bool share_bits(const DbcEntry& left, const DbcEntry& right) {
  if (left.signal.id != right.signal.id) return false;
  if (!left.conditions.empty() || !right.conditions.empty()) return false;
  if (bytes_needed(left.signal) > 8 || bytes_needed(right.signal) > 8) return false;
  CanFrame a;
  CanFrame b;
  a.length = b.length = 8;
  write_raw(left.signal, ~std::uint64_t{0}, a);
  write_raw(right.signal, ~std::uint64_t{0}, b);
  for (std::size_t i = 0; i < 8; ++i) {
    if ((a.data[i] & b.data[i]) != 0) return true;
  }
  return false;
}

dbc::Codec make_dbc(const dbc::Config& config, Problems& problems) {
  if (config.file.empty()) {
    problems.add("dbc.file is missing, expected the base's DBC file");
    return {};
  }
  const auto file = load_dbc(config.file);
  if (!file.ok()) {
    problems.add(file.error().message);
    return {};
  }
  const auto left =
      take_signal(*file, "dbc.left_signal", config.left_signal, config.quantity, problems);
  const auto right =
      take_signal(*file, "dbc.right_signal", config.right_signal, config.quantity, problems);
  if (!left || !right) return {};
  if (left->message == right->message && left->name == right->name) {
    problems.add("dbc: both wheels are the signal " + config.left_signal);
  } else if (share_bits(*left, *right)) {
    problems.add("dbc: " + config.left_signal + " and " + config.right_signal +
                 " are read from the same bits, expected bits of their own: correct their SG_ "
                 "lines");
  }
  return {left->signal,           right->signal,    config.quantity,
          config.metres_per_unit, left->conditions, right->conditions};
}

WheelCodec make_codec(const WheelCodecConfig& config, Problems& problems) {
  switch (config.kind) {
    case WheelCodecKind::kAgilexV2:
      break;
    case WheelCodecKind::kOdrive:
      check_different("odrive: the node", config.odrive.left_node, config.odrive.right_node,
                      problems);
      return odrive::Codec{config.odrive};
    case WheelCodecKind::kVesc:
      check_different("vesc: the controller's id", config.vesc.left_id, config.vesc.right_id,
                      problems);
      return vesc::Codec{config.vesc};
    case WheelCodecKind::kCanopen:
      check_canopen(config.canopen, problems);
      return canopen::Codec{config.canopen};
    case WheelCodecKind::kDbc:
      return make_dbc(config.dbc, problems);
  }
  return agilex_v2::Codec{};
}

// The base's left becomes the robot's right.
void swap_wheels(agilex_v2::Codec& codec) {
  codec.swap_wheels = true;
}
void swap_wheels(odrive::Codec& codec) {
  std::swap(codec.config.left_node, codec.config.right_node);
}
void swap_wheels(vesc::Codec& codec) {
  std::swap(codec.config.left_id, codec.config.right_id);
}
void swap_wheels(canopen::Codec& codec) {
  std::swap(codec.config.left, codec.config.right);
}
void swap_wheels(dbc::Codec& codec) {
  std::swap(codec.left, codec.right);
  std::swap(codec.left_when, codec.right_when);
}

}  // namespace

WheelQuantity wheel_quantity(const WheelCodecConfig& config) {
  switch (config.kind) {
    case WheelCodecKind::kAgilexV2:
      return WheelQuantity::kPosition;
    case WheelCodecKind::kOdrive:
      return config.odrive.quantity;
    case WheelCodecKind::kVesc:
      return config.vesc.quantity;
    case WheelCodecKind::kCanopen:
      return config.canopen.quantity;
    case WheelCodecKind::kDbc:
      return config.dbc.quantity;
  }
  return WheelQuantity::kPosition;
}

Result<WheelDecoder> make_wheel_decoder(const WheelCodecConfig& config) {
  Problems problems(config.kind);
  check_ranges(config, problems);
  WheelCodec codec = make_codec(config, problems);
  if (problems.any()) return problems.error();
  if (config.swap_wheels) std::visit([](auto& c) { swap_wheels(c); }, codec);
  WheelScales scales = std::visit([&](const auto& c) { return c.scales(config.geometry); }, codec);
  if (config.invert_left) scales.left.metres_per_unit *= -1.0;
  if (config.invert_right) scales.right.metres_per_unit *= -1.0;
  WheelDecoder decoder(codec, scales, config.limits);
  decoder.set_latency(Duration::from_seconds(config.latency_s));
  return decoder;
}

}  // namespace zenith
