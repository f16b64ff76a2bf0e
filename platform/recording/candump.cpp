#include "platform/recording/candump.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <optional>

#include "platform/recording/seconds.h"

namespace zenith {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::uint32_t kMostStandard = 0x7FF;
constexpr std::uint32_t kMostExtended = 0x1FFFFFFF;
// Before the point; candump fills up with zeros.
constexpr std::size_t kAbsoluteDigits = 10;
constexpr std::size_t kRelativeDigits = 3;

std::string_view take_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return rest = {};
  const std::size_t end = rest.find_first_of(" \t", begin);
  const std::string_view word = rest.substr(begin, end - begin);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  return word;
}

std::optional<std::uint32_t> parse_number(std::string_view text, int base) {
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value, base);
  if (text.empty() || status != std::errc() || stop != end) return std::nullopt;
  return value;
}

// "2018-12-06 09:31:30.572475"
std::optional<Time> parse_date(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00 00:00:00";
  constexpr std::array<std::size_t, 6> kAt = {0, 5, 8, 11, 14, 17};
  if (text.size() < kForm.size()) return std::nullopt;
  std::array<std::uint32_t, 6> parts = {};
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] != '0' && text[i] != kForm[i]) return std::nullopt;
  }
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    const auto part = parse_number(text.substr(kAt[i], i == 0 ? 4 : 2), 10);
    if (!part) return std::nullopt;
    parts[i] = *part;
  }
  const std::chrono::year_month_day day{std::chrono::year{static_cast<int>(parts[0])},
                                        std::chrono::month{parts[1]}, std::chrono::day{parts[2]}};
  if (!day.ok() || parts[0] < 1970 || parts[3] > 23 || parts[4] > 59 || parts[5] > 60) {
    return std::nullopt;
  }
  const std::int64_t days = std::chrono::sys_days{day}.time_since_epoch().count();
  const std::int64_t seconds = 86400 * days + 3600 * parts[3] + 60 * parts[4] + parts[5];
  const auto rest = parse_seconds("0" + std::string(text.substr(kForm.size())));
  if (!rest || rest->ns >= 1'000'000'000) return std::nullopt;
  return Time{seconds * 1'000'000'000 + rest->ns};
}

// The stamp at the begin of a line, if it has one; false when there is one that is malformed.
bool take_stamp(std::string_view& rest, CandumpRecord& record) {
  const std::size_t begin = rest.find_first_not_of(" \t");
  if (begin == std::string_view::npos || rest[begin] != '(') return true;
  const std::size_t end = rest.find(')', begin);
  if (end == std::string_view::npos) return false;
  const std::string_view text = rest.substr(begin + 1, end - begin - 1);
  rest.remove_prefix(end + 1);
  const bool date = text.find('-') != std::string_view::npos;
  const auto time = date ? parse_date(text) : parse_seconds(text);
  if (!time) return false;
  record.frame.stamp = *time;
  const std::size_t digits = std::min(text.find('.'), text.size());
  const bool few = digits >= kRelativeDigits && digits < kAbsoluteDigits;
  record.stamp = date  ? CandumpStamp::kLocalDate
                 : few ? CandumpStamp::kFewSeconds
                       : CandumpStamp::kSeconds;
  return true;
}

// The identifier of a frame; an error frame's has a flag.
bool parse_id(std::string_view text, CanFrame& frame, bool& error) {
  const auto id = parse_number(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return false;
  frame.extended = text.size() == 8;
  error = frame.extended && (*id & kErrorFlag) != 0;
  frame.id = *id;
  return error || *id <= (frame.extended ? kMostExtended : kMostStandard);
}

bool is_direction(std::string_view word) {
  return word == "R" || word == "T" || word == "RX" || word == "TX" || word == "Rx" || word == "Tx";
}

bool push_byte(std::string_view text, int base, CanFrame& frame) {
  const auto byte = parse_number(text, base);
  if (!byte || text.size() != (base == 16 ? 2U : 8U) || frame.length == frame.data.size()) {
    return false;
  }
  frame.data[frame.length++] = static_cast<std::uint8_t>(*byte);
  return true;
}

// What stands behind "ID#".
CandumpLine parse_log_data(std::string_view text, CanFrame& frame) {
  if (!text.empty() && (text[0] == 'R' || text[0] == 'r')) return CandumpLine::kRemote;
  if (!text.empty() && text[0] == '#') return CandumpLine::kFd;
  // The raw length of a frame of eight bytes: "_9" to "_F".
  if (text.size() == 18 && text[16] == '_') text = text.substr(0, 16);
  if (text.size() % 2 != 0) return CandumpLine::kMalformed;
  for (; !text.empty(); text.remove_prefix(2)) {
    if (!push_byte(text.substr(0, 2), 16, frame)) return CandumpLine::kMalformed;
  }
  return CandumpLine::kFrame;
}

// ID#DATA [direction]
CandumpLine parse_log(std::string_view content, std::string_view rest, CanFrame& frame) {
  const std::size_t hash = content.find('#');
  const std::string_view direction = take_word(rest);
  bool error = false;
  if (!parse_id(content.substr(0, hash), frame, error)) return CandumpLine::kMalformed;
  if (!direction.empty() && !is_direction(direction)) return CandumpLine::kMalformed;
  if (!direction.empty()) {
    // candump -x: the flags of CAN FD behind the direction.
    for (std::string_view flag; !(flag = take_word(rest)).empty();) {
      if (flag != "B" && flag != "E" && flag != "-") return CandumpLine::kMalformed;
    }
  }
  return error ? CandumpLine::kError : parse_log_data(content.substr(hash + 1), frame);
}

// Bytes in one of candump's forms, then perhaps the same in ASCII.
bool parse_column_data(std::string_view rest, std::uint32_t length, CanFrame& frame) {
  std::string_view words = rest;
  const std::string_view first = take_word(words);
  if (length > 1 && first.find('`') != std::string_view::npos && first.front() != '`') {
    // -S: the last byte first, one word.
    for (std::size_t at = first.size(); at != std::string_view::npos;) {
      const std::size_t mark = first.substr(0, at).rfind('`');
      const std::size_t begin = mark == std::string_view::npos ? 0 : mark + 1;
      const std::string_view byte = first.substr(begin, at - begin);
      if (!push_byte(byte, byte.size() == 8 ? 2 : 16, frame)) return false;
      at = mark;
    }
    rest = words;
  } else {
    for (std::uint32_t i = 0; i < length; ++i) {
      const std::string_view byte = take_word(rest);
      if (!push_byte(byte, byte.size() == 8 ? 2 : 16, frame)) return false;
    }
  }
  const std::size_t more = rest.find_first_not_of(" \t");
  return frame.length == length &&
         (more == std::string_view::npos || rest[more] == '\'' || rest[more] == '`');
}

// ID [length] bytes; `id` and `bracket` are the first two words.
CandumpLine parse_columns(std::string_view id, std::string_view bracket, std::string_view rest,
                          CanFrame& frame) {
  const bool raw = bracket.front() == '{';  // the raw length of eight bytes
  if (bracket.size() < 3 || bracket.back() != (raw ? '}' : ']')) return CandumpLine::kMalformed;
  bool error = false;
  const std::string_view digits = bracket.substr(1, bracket.size() - 2);
  const auto length = parse_number(digits, raw ? 16 : 10);
  if (!parse_id(id, frame, error) || !length) return CandumpLine::kMalformed;
  if (error) return CandumpLine::kError;
  if (digits.size() > 1) return CandumpLine::kFd;
  std::string_view words = rest;
  if (take_word(words) == "remote") return CandumpLine::kRemote;
  const std::uint32_t bytes = raw ? std::min<std::uint32_t>(*length, 8) : *length;
  return parse_column_data(rest, bytes, frame) ? CandumpLine::kFrame : CandumpLine::kMalformed;
}

}  // namespace

CandumpRecord parse_candump(std::string_view line) {
  constexpr std::size_t kMostWords = 6;  // interface, RX, two flags, ID, length
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  CandumpRecord record;
  const bool indented = !line.empty() && line.front() == '\t';  // about an error frame, with -e
  if (indented || line.find_first_not_of(" \t") == std::string_view::npos) {
    record.line = CandumpLine::kEmpty;
    return record;
  }
  if (line.starts_with("DROPCOUNT:")) {
    record.line = CandumpLine::kDropped;
    return record;
  }
  if (!take_stamp(line, record)) return record;
  std::array<std::string_view, kMostWords> words;
  for (std::size_t count = 0; count < kMostWords; ++count) {
    words[count] = take_word(line);
    if (words[count].empty()) return record;
    const bool bracket = words[count].front() == '[' || words[count].front() == '{';
    if (count <= 1 && words[count].find('#') != std::string_view::npos) {
      record.line = parse_log(words[count], line, record.frame);
      record.interface = count == 1 ? words[0] : std::string_view();
      return record;
    }
    if (!bracket) continue;
    // [interface] [direction flag flag] ID
    const bool directed = count >= 4 && is_direction(words[count - 4]);
    const std::size_t before = directed ? count - 4 : count - 1;
    if (count == 0 || before > 1) return record;
    record.columns = true;
    record.interface = before == 1 ? words[0] : std::string_view();
    record.line = parse_columns(words[count - 1], words[count], line, record.frame);
    return record;
  }
  return record;
}

std::string without_colours(std::string_view line) {
  std::string text;
  while (!line.empty()) {
    const std::size_t escape = std::min(line.find("\x1b["), line.size());
    text += line.substr(0, escape);
    line.remove_prefix(escape);
    if (line.empty()) break;
    line.remove_prefix(std::min(line.find_first_not_of("0123456789;", 2), line.size()));
    if (!line.empty()) line.remove_prefix(1);
  }
  return text;
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
