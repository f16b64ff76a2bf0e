#include "platform/recording/candump.h"

#include <charconv>
#include <cstdio>
#include <optional>

#include "platform/recording/seconds.h"

namespace zenith {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;

std::string_view take_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return rest = {};
  const std::size_t end = rest.find_first_of(" \t", begin);
  const std::string_view word = rest.substr(begin, end - begin);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  return word;
}

std::optional<std::uint32_t> parse_hex(std::string_view text) {
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value, 16);
  if (text.empty() || status != std::errc() || stop != end) return std::nullopt;
  return value;
}

CandumpLine parse_data(std::string_view text, CanFrame& frame) {
  if (!text.empty() && (text[0] == 'R' || text[0] == '#')) return CandumpLine::kOther;
  if (text.size() % 2 != 0 || text.size() > 16) return CandumpLine::kMalformed;
  frame.length = static_cast<std::uint8_t>(text.size() / 2);
  for (std::size_t i = 0; i < frame.length; ++i) {
    const auto byte = parse_hex(text.substr(2 * i, 2));
    if (!byte) return CandumpLine::kMalformed;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return CandumpLine::kFrame;
}

}  // namespace

CandumpLine parse_candump(std::string_view line, CanFrame& frame, std::string_view& interface) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  const std::string_view stamp = take_word(line);
  if (stamp.empty()) return CandumpLine::kOther;
  if (stamp.size() < 3 || stamp.front() != '(' || stamp.back() != ')') {
    return CandumpLine::kMalformed;
  }
  const auto time = parse_seconds(stamp.substr(1, stamp.size() - 2));
  interface = take_word(line);
  const std::string_view content = take_word(line);
  const std::string_view direction = take_word(line);  // R or T, with candump -x
  const std::size_t hash = content.find('#');
  if (!time || hash == std::string_view::npos) return CandumpLine::kMalformed;
  if (!(direction.empty() || direction == "R" || direction == "T")) return CandumpLine::kMalformed;
  const auto id = parse_hex(content.substr(0, hash));
  if (!id || (hash != 3 && hash != 8)) return CandumpLine::kMalformed;
  frame = {};
  frame.stamp = *time;
  frame.id = *id;
  frame.extended = hash == 8;
  if (frame.extended && (*id & kErrorFlag) != 0) return CandumpLine::kOther;
  if (*id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) return CandumpLine::kMalformed;
  return parse_data(content.substr(hash + 1), frame);
}

std::string format_candump(const CanFrame& frame, std::string_view interface) {
  char text[64];
  // Microseconds, as candump writes them, are finer than any bus is in time.
  const std::int64_t microseconds = frame.stamp.ns / 1000;
  std::snprintf(text, sizeof text, "(%010lld.%06lld) ",
                static_cast<long long>(microseconds / 1'000'000),
                static_cast<long long>(microseconds % 1'000'000));
  std::string line = text + std::string(interface);
  std::snprintf(text, sizeof text, frame.extended ? " %08X#" : " %03X#", frame.id);
  line += text;
  for (int i = 0; i < frame.length; ++i) {
    std::snprintf(text, sizeof text, "%02X", frame.data[static_cast<std::size_t>(i)]);
    line += text;
  }
  return line;
}

}  // namespace zenith
