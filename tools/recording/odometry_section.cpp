#include "tools/recording/odometry_section.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "tools/recording/toml_keys.h"

namespace zenith::tools {
namespace {

// Splits "odrive.left_node"; the section is empty for keys without one.
std::pair<std::string, std::string> split_key(std::string_view key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return {"", std::string(key)};
  return {std::string(key.substr(0, dot)), std::string(key.substr(dot + 1))};
}

// The keys under [odometry], or those under one of its sections.
std::vector<std::string> odometry_keys(const std::string& wanted) {
  std::vector<std::string> keys;
  if (wanted.empty()) keys = {"codec", "can_interface"};
  for (const WheelCodecField& field : wheel_codec_fields()) {
    const auto [section, key] = split_key(field.key);
    const std::string& listed = section == wanted ? key : section;
    if (section != wanted && !wanted.empty()) continue;
    if (std::find(keys.begin(), keys.end(), listed) == keys.end()) keys.push_back(listed);
  }
  return keys;
}

// Values of the table's types, each with a text that says what was expected instead.
struct FieldReader {
  const toml::node& node;
  WheelCodecConfig& config;

  template <typename Number>
  const char* operator()(Number* (*at)(WheelCodecConfig&)) const {
    if constexpr (std::is_same_v<Number, double>) {
      return set(node.value<double>(), *at(config), "no number");
    } else if constexpr (std::is_same_v<Number, bool>) {
      return set(node.value_exact<bool>(), *at(config), "neither true nor false");
    } else if constexpr (std::is_same_v<Number, std::uint32_t>) {
      return set(node.value<std::uint32_t>(), *at(config), "no whole number from 0 on");
    } else if constexpr (std::is_same_v<Number, std::string>) {
      return set(node.value_exact<std::string>(), *at(config), "no text");
    } else {
      return set(find_wheel_quantity(node.value_or(std::string_view())), *at(config),
                 "neither \"position\" nor \"velocity\"");
    }
  }

  template <typename T>
  static const char* set(const std::optional<T>& found, T& value, const char* problem) {
    if (!found) return problem;
    value = *found;
    return nullptr;
  }
};

struct FieldWriter {
  WheelCodecConfig& config;

  template <typename T>
  std::string operator()(T* (*at)(WheelCodecConfig&)) const {
    const T& value = *at(config);
    if constexpr (std::is_same_v<T, bool>) return value ? "true" : "false";
    if constexpr (std::is_same_v<T, std::uint32_t>) return std::to_string(value);
    if constexpr (std::is_same_v<T, std::string>) return toml_text(value);
    if constexpr (std::is_same_v<T, WheelQuantity>) {
      return "\"" + std::string(wheel_quantity_name(value)) + "\"";
    }
    if constexpr (std::is_same_v<T, double>) {
      char text[40];
      return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
    }
  }

  static std::string toml_text(const std::string& value) {
    std::string text = "\"";
    for (const char c : value) {
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
    return text + "\"";
  }
};

}  // namespace

std::string toml_value(const WheelCodecField& field, WheelCodecConfig& config) {
  return std::visit(FieldWriter{config}, field.at);
}

void read_odometry(const toml::table& file, WheelCodecConfig& config, Problems& problems) {
  check_section(file, "odometry", odometry_keys(""), problems);
  const auto odometry = file["odometry"];
  for (const WheelCodecKind kind : {WheelCodecKind::kOdrive, WheelCodecKind::kVesc,
                                    WheelCodecKind::kCanopen, WheelCodecKind::kDbc}) {
    const std::string section(wheel_codec_name(kind));
    const auto node = odometry[section];
    const std::string name = "odometry." + section;
    if (const toml::table* table = node.as_table()) {
      check_keys(*table, name + ".", odometry_keys(section), problems);
    } else if (node) {
      problems.add(line_of(*node.node()), name + " is no section");
    }
  }
  for (const WheelCodecField& field : wheel_codec_fields()) {
    const auto [section, key] = split_key(field.key);
    const auto found = section.empty() ? odometry[key] : odometry[section][key];
    if (!found) continue;
    const char* problem = std::visit(FieldReader{*found.node(), config}, field.at);
    if (problem == nullptr) continue;
    problems.add(line_of(*found.node()), "odometry." + std::string(field.key) + " is " + problem);
  }
  std::string codec(wheel_codec_name(config.kind));
  read_text(file, "odometry", "codec", codec, problems);
  const auto kind = find_wheel_codec(codec);
  if (kind) config.kind = *kind;
  if (!kind) {
    problems.add(0, "odometry.codec '" + codec + "' is unknown; known: " + wheel_codec_names());
  }
}

std::string format_odometry(WheelCodecConfig config) {
  WheelCodecConfig defaults;
  std::string text;
  std::string current;
  for (const WheelCodecField& field : wheel_codec_fields()) {
    if (!field.belongs_to(config.kind)) continue;
    const auto [section, key] = split_key(field.key);
    const std::string value = toml_value(field, config);
    if (section.empty() && value == toml_value(field, defaults)) continue;
    if (section != current) text += "\n[odometry." + section + "]\n";
    current = section;
    text += key + " = " + value + "   # " + std::string(field.text) + "\n";
  }
  return text;
}

}  // namespace zenith::tools
