#pragma once
// Seconds as decimal text, exact to the nanosecond: a double of today's epoch seconds is not.

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "platform/base/time.h"

namespace zenith {

// "12", "12.5", "1436509052.249713": digits, and up to nine decimals are used.
inline std::optional<Time> parse_seconds(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  std::string decimals(dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1));
  if (whole.empty() || whole.size() > 9 + 1) return std::nullopt;
  if (whole.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  if (decimals.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  decimals.resize(9, '0');
  std::int64_t seconds = 0;
  std::int64_t nanoseconds = 0;
  std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::from_chars(decimals.data(), decimals.data() + decimals.size(), nanoseconds);
  if (seconds > 9'000'000'000) return std::nullopt;
  return Time{seconds * 1'000'000'000 + nanoseconds};
}

inline std::string format_seconds(Time time) {
  char text[32];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(time.ns / 1'000'000'000),
                static_cast<long long>(time.ns % 1'000'000'000));
  return text;
}

}  // namespace zenith
