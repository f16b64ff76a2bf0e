#pragma once
// JSON from outside: parsed within limits that are checked before, and read without exceptions.
//
// A parser without limits takes a hundred bytes of memory for one byte of text. Here a text costs
// some 64 bytes for each of at most `values` values.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace zenith::tools {

struct JsonLimits {
  std::size_t bytes = std::size_t{64} << 10U;
  std::size_t depth = 8;  // of arrays and objects in each other
  std::size_t values = 4096;
};

enum class JsonFault { kNone, kTooLong, kTooDeep, kTooMany, kNotJson };

struct ParsedJson {
  nlohmann::json value;  // null after a fault
  JsonFault fault = JsonFault::kNone;
};

// Invalid UTF-8 and numbers beyond a double are kNotJson.
ParsedJson parse_bounded(std::string_view text, const JsonLimits& limits);

// --- Reading: nothing when it is absent or of another type. --------------------------------------

// A member of an object; null when there is none.
const nlohmann::json& member(const nlohmann::json& object, std::string_view key);
// At a path such as "/camera/up" or "/pose/0"; null when nothing is there.
const nlohmann::json& value_at(const nlohmann::json& value, std::string_view path);

// Finite, and within the bounds.
std::optional<double> read_number(const nlohmann::json& value,
                                  double least = std::numeric_limits<double>::lowest(),
                                  double most = std::numeric_limits<double>::max());
// Whole, also when it is written as 2.0.
std::optional<std::int64_t> read_integer(const nlohmann::json& value, std::int64_t least,
                                         std::int64_t most);
std::optional<bool> read_flag(const nlohmann::json& value);
// Not longer than `most` bytes, and printable (printable.h).
std::optional<std::string> read_text(const nlohmann::json& value, std::size_t most);

// Exactly so many numbers, none beyond `most` from zero.
template <std::size_t Count>
std::optional<std::array<double, Count>> read_numbers(const nlohmann::json& value, double most) {
  if (!value.is_array() || value.size() != Count) return std::nullopt;
  std::array<double, Count> numbers;
  for (std::size_t i = 0; i < Count; ++i) {
    const auto number = read_number(value[i], -most, most);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  return numbers;
}

}  // namespace zenith::tools
