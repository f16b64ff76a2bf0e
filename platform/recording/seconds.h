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

// "12", "12.5", "1436509052.249713": digits, and up to nine decimals are used. Also with an
// exponent, as NumPy writes them: "1.436509052249713000e+09".
inline std::optional<Time> parse_seconds(std::string_view text) {
  constexpr int kMostExponent = 9;
  int exponent = 0;
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    std::string_view power = text.substr(e + 1);
    if (!power.empty() && power.front() == '+') power.remove_prefix(1);
    const char* end = power.data() + power.size();
    const auto [stop, status] = std::from_chars(power.data(), end, exponent);
    if (power.empty() || status != std::errc() || stop != end) return std::nullopt;
    if (exponent < -kMostExponent || exponent > kMostExponent) return std::nullopt;
    text = text.substr(0, e);
  }
  const std::size_t dot = text.find('.');
  std::string whole(text.substr(0, dot));
  std::string decimals(dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1));
  if (whole.empty() || whole.size() > 9 + 1) return std::nullopt;
  if (whole.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  if (decimals.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  for (; exponent > 0; --exponent) {
    whole += decimals.empty() ? '0' : decimals.front();
    decimals.erase(0, 1);
  }
  for (; exponent < 0; ++exponent) {
    decimals.insert(0, 1, whole.empty() ? '0' : whole.back());
    if (!whole.empty()) whole.pop_back();
  }
  decimals.resize(9, '0');
  std::int64_t seconds = 0;
  std::int64_t nanoseconds = 0;
  const auto read = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::from_chars(decimals.data(), decimals.data() + decimals.size(), nanoseconds);
  if (read.ec == std::errc::result_out_of_range || seconds > 9'000'000'000) return std::nullopt;
  return Time{seconds * 1'000'000'000 + nanoseconds};
}

inline std::string format_seconds(Time time) {
  char text[32];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(time.ns / 1'000'000'000),
                static_cast<long long>(time.ns % 1'000'000'000));
  return text;
}

}  // namespace zenith
