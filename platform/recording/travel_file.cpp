#include "platform/recording/travel_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/base/printable.h"
#include "platform/recording/seconds.h"

namespace zenith {
namespace {

constexpr LineLimits kLimits = {128 * kMaxTravelLines};
constexpr const char* kForm = "expected 'stamp,left_m,right_m': seconds, and metres of travel";

// Where the columns of a line are.
struct Columns {
  std::size_t stamp = 0;
  std::size_t left = 1;
  std::size_t right = 2;
  bool nanoseconds = false;
};

std::string_view trim(std::string_view text) {
  constexpr std::string_view kAround = " \t\"'";
  const std::size_t begin = text.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kAround) - begin + 1);
}

// Between marks each field counts, also an empty one; between blanks there is none.
std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (const char mark : {',', ';', '\t'}) {
    if (line.find(mark) == std::string_view::npos) continue;
    for (;;) {
      const std::size_t end = line.find(mark);
      fields.push_back(trim(line.substr(0, end)));
      if (end == std::string_view::npos) return fields;
      line.remove_prefix(end + 1);
    }
  }
  while (!(line = trim(line)).empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return fields;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// The unit at the end of a column's name: "stamp_ns", "left [m]", "right(mm)".
std::string unit_of(const std::string& name) {
  const std::size_t open = name.find_last_of("[(");
  if (open != std::string::npos) {
    return name.substr(open + 1, name.find_first_of("])", open) - open - 1);
  }
  const std::size_t bar = name.find_last_of("_ ");
  return bar == std::string::npos ? "" : name.substr(bar + 1);
}

// A column whose name has one of the words; npos: none, or not one alone.
std::size_t find_column(const std::vector<std::string>& names,
                        std::initializer_list<std::string_view> words) {
  std::size_t found = std::string::npos;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto has = [&](std::string_view word) {
      return names[i].find(word) != std::string::npos;
    };
    if (!std::any_of(words.begin(), words.end(), has)) continue;
    if (found != std::string::npos) return std::string::npos;
    found = i;
  }
  return found;
}

// What the heading says; an error when it says something that is not read here.
Result<Columns> read_heading(const InputLines& file, std::string_view line) {
  std::vector<std::string> names;
  for (const std::string_view field : split(line)) names.push_back(lower(field));
  const Error unclear =
      file.error(std::string(kForm) + ", found the heading '" + printable_start(line, 80) + "'");
  Columns columns;
  columns.left = find_column(names, {"left"});
  columns.right = find_column(names, {"right"});
  columns.stamp = find_column(names, {"stamp", "time", "sec"});
  if (columns.stamp == std::string::npos) {
    const auto t = std::find(names.begin(), names.end(), "t");
    if (t != names.end()) columns.stamp = static_cast<std::size_t>(t - names.begin());
  }
  if (std::max({columns.left, columns.right, columns.stamp}) == std::string::npos ||
      columns.left == columns.right || columns.stamp == columns.left ||
      columns.stamp == columns.right) {
    return unclear;
  }
  for (const std::size_t column : {columns.left, columns.right}) {
    const std::string unit = unit_of(names[column]);
    if (unit != "m" && unit != "" && unit != "travel" && unit != "wheel" && unit != "metres" &&
        unit != "meters") {
      return Error{unclear.message + ", whose column '" + printable_start(names[column], 40) +
                   "' is in another unit"};
    }
  }
  const std::string unit = unit_of(names[columns.stamp]);
  columns.nanoseconds = unit == "ns" || unit == "nsec" || unit == "nanoseconds";
  if (unit == "ms" || unit == "us" || unit == "msec" || unit == "usec") {
    return Error{unclear.message + ", whose stamps are neither seconds nor nanoseconds (ns)"};
  }
  return columns;
}

std::optional<double> parse_metres(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (text.empty() || status != std::errc() || stop != end || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<Time> parse_stamp(std::string_view text, bool nanoseconds) {
  if (!nanoseconds) return parse_seconds(text);
  Time time;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, time.ns);
  if (text.empty() || status != std::errc() || stop != end || time.ns < 0) return std::nullopt;
  return time;
}

std::optional<WheelSample> parse_line(std::string_view line, const Columns& columns) {
  const std::vector<std::string_view> fields = split(line);
  if (fields.size() <= std::max({columns.stamp, columns.left, columns.right})) return std::nullopt;
  const auto stamp = parse_stamp(fields[columns.stamp], columns.nanoseconds);
  const auto left = parse_metres(fields[columns.left]);
  const auto right = parse_metres(fields[columns.right]);
  if (!stamp || !left || !right) return std::nullopt;
  return WheelSample{*stamp, *left, *right};
}

// Whether a line is the one that names the columns: a comment that names both wheels, or whatever
// does not begin with a number.
bool is_heading(std::string_view line) {
  if (line.front() == '#') {
    const std::string text = lower(line);
    return split(line).size() >= 3 && text.find("left") != std::string::npos &&
           text.find("right") != std::string::npos && text.find("stamp") < text.size();
  }
  const char first = trim(line).empty() ? ' ' : trim(line).front();
  return std::isdigit(static_cast<unsigned char>(first)) == 0 && first != '+' && first != '-' &&
         first != '.';
}

}  // namespace

WheelDecoder travel_decoder(const WheelCodecConfig& config) {
  WheelScales scales;
  scales.left = {WheelKind::kPosition, 64, config.invert_left ? -1.0 : 1.0};
  scales.right = {WheelKind::kPosition, 64, config.invert_right ? -1.0 : 1.0};
  WheelDecoder decoder(agilex_v2::Codec{}, scales, config.limits);
  decoder.set_latency(Duration::from_seconds(config.latency_s));
  return decoder;
}

Result<WheelLog> parse_travel_file(InputLines& file, const WheelCodecConfig& config) {
  WheelDecoder decoder = travel_decoder(config);
  WheelLog log;
  Columns columns;
  bool begun = false;  // the columns are known
  std::string_view line;
  while (file.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    if (!begun && is_heading(line)) {
      const auto read = read_heading(file, line.substr(line.front() == '#' ? 1 : 0));
      if (!read.ok()) return read.error();
      columns = *read;
      begun = true;
      continue;
    }
    if (line.front() == '#') continue;
    begun = true;
    auto sample = parse_line(line, columns);
    if (!sample) {
      if (log.malformed++ == 0) {
        log.first_malformed =
            file.place() + ": " + kForm + ", found '" + printable_start(line, 80) + "'";
      }
      continue;
    }
    if (log.samples.size() == kMaxTravelLines) {
      return file.error("expected at most " + std::to_string(kMaxTravelLines) +
                        " samples; record a long drive in parts");
    }
    if (config.swap_wheels) std::swap(sample->left_m, sample->right_m);
    WheelNews news;
    news.left = WheelReading{.value = sample->left_m};
    news.right = WheelReading{.value = sample->right_m};
    if (const auto taken = decoder.take(sample->stamp, news)) log.samples.push_back(*taken);
  }
  if (!file.status()) return file.status().error();
  log.decoder = decoder.counters();
  log.fault = decoder.fault();
  return check_log(std::move(log), file.name());
}

Result<WheelLog> read_travel_file(const std::filesystem::path& path,
                                  const WheelCodecConfig& config) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_travel_file(*file, config);
}

}  // namespace zenith
