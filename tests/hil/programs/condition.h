#pragma once
// What is expected of a line of telemetry: "health.camera.up=true", "pose.inliers>=20". The first
// word is the line's type, the rest leads to the value.

#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace zenith::hil {

// "health.map.created" in a line of type "health"; nullptr when it is not there.
inline const nlohmann::json* find_value(const nlohmann::json& line, std::string_view path) {
  const nlohmann::json* at = &line;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string key(path.substr(0, dot));
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &(*at)[key];
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return at;
}

// What a person reads: texts without quotation marks.
inline std::string value_text(const nlohmann::json* value) {
  if (value == nullptr) return "not there";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

struct Condition {
  std::string text;  // as it was written
  std::string type;
  std::string path;
  std::string sign;  // =  !=  >=  <=  >  <
  std::string expected;

  static std::optional<Condition> parse(const std::string& text) {
    const std::size_t at = text.find_first_of("=<>!");
    const std::size_t dot = text.find('.');
    if (at == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 >= at) {
      return std::nullopt;
    }
    const bool two = at + 1 < text.size() && text[at + 1] == '=' && text[at] != '=';
    Condition c;
    c.text = text;
    c.type = text.substr(0, dot);
    c.path = text.substr(dot + 1, at - dot - 1);
    c.sign = text.substr(at, two ? 2 : 1);
    c.expected = text.substr(at + c.sign.size());
    if (c.sign == "!" || c.expected.empty()) return std::nullopt;
    const bool orders = c.sign[0] == '<' || c.sign[0] == '>';
    if (orders && !number(c.expected)) return std::nullopt;
    return c;
  }

  // Of a line of this type. A value that is not there meets nothing, nor does null.
  bool met_by(const nlohmann::json& line) const {
    const nlohmann::json* value = find_value(line, path);
    if (value == nullptr || value->is_null()) return false;
    if (sign == "=") return value_text(value) == expected;
    if (sign == "!=") return value_text(value) != expected;
    if (!value->is_number()) return false;
    const double limit = *number(expected);
    const double is = value->get<double>();
    if (sign == ">=") return is >= limit;
    if (sign == "<=") return is <= limit;
    return sign == ">" ? is > limit : is < limit;
  }

 private:
  static std::optional<double> number(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0') return std::nullopt;
    return value;
  }
};

}  // namespace zenith::hil
