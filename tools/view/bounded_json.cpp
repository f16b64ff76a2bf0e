#include "tools/view/bounded_json.h"

#include <algorithm>
#include <charconv>

#include "platform/base/printable.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

const json kNull;

// Counts brackets and separators outside of strings. What it counts wrongly is no JSON anyway.
JsonFault measure(std::string_view text, const JsonLimits& limits) {
  std::size_t depth = 0;
  std::size_t values = 1;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
      continue;
    }
    in_string = c == '"';
    if (c == '[' || c == '{') {
      if (++depth > limits.depth) return JsonFault::kTooDeep;
      ++values;
    } else if (c == ']' || c == '}') {
      depth -= depth > 0 ? 1 : 0;
    } else if (c == ',') {
      ++values;
    }
    if (values > limits.values) return JsonFault::kTooMany;
  }
  return JsonFault::kNone;
}

}  // namespace

ParsedJson parse_bounded(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes) return {nullptr, JsonFault::kTooLong};
  if (const JsonFault fault = measure(text, limits); fault != JsonFault::kNone) {
    return {nullptr, fault};
  }
  ParsedJson parsed = {json::parse(text.begin(), text.end(), nullptr, false), JsonFault::kNone};
  if (parsed.value.is_discarded()) return {nullptr, JsonFault::kNotJson};
  return parsed;
}

const json& member(const json& object, std::string_view key) {
  if (!object.is_object()) return kNull;
  const auto found = object.find(std::string(key));
  return found == object.end() ? kNull : *found;
}

const json& value_at(const json& value, std::string_view path) {
  const json* at = &value;
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view key = path.substr(0, end);
    path.remove_prefix(end);
    if (!at->is_array()) {
      at = &member(*at, key);
      continue;
    }
    std::size_t index = 0;
    const auto read = std::from_chars(key.data(), key.data() + key.size(), index);
    const bool good = read.ec == std::errc() && read.ptr == key.data() + key.size();
    if (!good || index >= at->size()) return kNull;
    at = &(*at)[index];
  }
  return *at;
}

std::optional<double> read_number(const json& value, double least, double most) {
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  if (!std::isfinite(number) || number < least || number > most) return std::nullopt;
  return number;
}

std::optional<std::int64_t> read_integer(const json& value, std::int64_t least, std::int64_t most) {
  std::int64_t whole = 0;
  if (value.is_number_unsigned()) {
    const auto big = value.get<std::uint64_t>();
    if (big > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return std::nullopt;
    }
    whole = static_cast<std::int64_t>(big);
  } else if (value.is_number_integer()) {
    whole = value.get<std::int64_t>();
  } else {
    constexpr double kMost = 9.2e18;  // fits int64_t
    const auto number = read_number(value, -kMost, kMost);
    if (!number || std::floor(*number) != *number) return std::nullopt;
    whole = static_cast<std::int64_t>(*number);
  }
  if (whole < least || whole > most) return std::nullopt;
  return whole;
}

std::optional<bool> read_flag(const json& value) {
  if (!value.is_boolean()) return std::nullopt;
  return value.get<bool>();
}

std::optional<std::string> read_text(const json& value, std::size_t most) {
  if (!value.is_string()) return std::nullopt;
  const auto& text = value.get_ref<const std::string&>();
  if (text.size() > most || !is_printable(text)) return std::nullopt;
  return text;
}

}  // namespace zenith::tools
