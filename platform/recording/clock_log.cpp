#include "platform/recording/clock_log.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>

#include "platform/base/printable.h"

namespace zenith {
namespace {

constexpr LineLimits kLimits = {100 * kMaxClockReadings, 256};
// Uptimes of 36 years, and the year 2116: sums stay within 64 bits.
constexpr std::int64_t kMostUptime_ns = std::int64_t{1} << 60U;
constexpr std::int64_t kMostWall_ns = std::int64_t{1} << 62U;

bool near(Duration a, Duration b) {
  const Duration apart = {a > b ? a.ns - b.ns : b.ns - a.ns};
  return apart < ClockChanges::kLeast;
}

// Four whole numbers, of which those of time are within bounds.
std::optional<ClockReading> parse_line(std::string_view line) {
  std::array<std::int64_t, 4> values = {};
  const char* at = line.data();
  const char* const end = line.data() + line.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [stop, status] = std::from_chars(at, end, values[i]);
    if (status != std::errc()) return std::nullopt;
    const bool last = i + 1 == values.size();
    if (last ? stop != end : (stop == end || *stop != ',')) return std::nullopt;
    at = stop + 1;
  }
  const auto uptime = [](std::int64_t ns) { return ns >= 0 && ns < kMostUptime_ns; };
  if (!uptime(values[0]) || !uptime(values[1]) || (values[3] != 0 && values[3] != 1)) {
    return std::nullopt;
  }
  if (values[2] >= kMostWall_ns || values[2] <= -kMostWall_ns) return std::nullopt;
  return ClockReading{{values[0]}, {values[1]}, {values[2]}, values[3] == 1};
}

}  // namespace

bool ClockChanges::is_change(const ClockReading& reading) {
  const bool same = last_ && near(last_->wall, reading.wall) &&
                    near(last_->suspended, reading.suspended) &&
                    last_->synchronised == reading.synchronised;
  if (!same) last_ = reading;
  return !same;
}

ClockLog::ClockLog(std::vector<ClockReading> readings) : readings_(std::move(readings)) {
  assert(!readings_.empty());
  // Readings of one and the same are off by microseconds: no reason for a stamp to fall behind.
  for (std::size_t i = 1; i < readings_.size(); ++i) {
    ClockReading& r = readings_[i];
    const Duration before = readings_[i - 1].suspended;
    if (near(r.suspended, before)) r.suspended = before;
  }
  trusted_ = readings_.back();
  const auto good = std::find_if(readings_.rbegin(), readings_.rend(),
                                 [](const ClockReading& r) { return r.synchronised; });
  if (good != readings_.rend()) trusted_ = *good;
}

Duration ClockLog::offset(Time stamp) const {
  const auto after =
      std::upper_bound(readings_.begin(), readings_.end(), stamp,
                       [](Time t, const ClockReading& reading) { return t < reading.monotonic; });
  const ClockReading& at = after == readings_.begin() ? readings_.front() : *(after - 1);
  return {at.suspended.ns + trusted_.wall.ns - trusted_.suspended.ns};
}

bool ClockLog::synchronised() const {
  return trusted_.synchronised;
}

Duration ClockLog::stepped() const {
  const ClockReading& a = readings_.front();
  const Duration step = {(trusted_.wall.ns - trusted_.suspended.ns) - (a.wall.ns - a.suspended.ns)};
  return near(step, {0}) ? Duration{0} : step;
}

Duration ClockLog::slept() const {
  return {readings_.back().suspended.ns - readings_.front().suspended.ns};
}

std::string format_clock_reading(const ClockReading& r) {
  return std::to_string(r.monotonic.ns) + ',' + std::to_string(r.suspended.ns) + ',' +
         std::to_string(r.wall.ns) + ',' + (r.synchronised ? '1' : '0') + '\n';
}

Result<ClockLog> parse_clock_log(InputLines& file) {
  std::vector<ClockReading> readings;
  std::string_view line;
  while (file.next(line)) {
    if (line.empty() || line[0] == '#') continue;
    const auto reading = parse_line(line);
    if (!reading) {
      return file.error(
          "expected 'monotonic ns,suspended ns,wall minus monotonic ns,0 or 1', "
          "found '" +
          printable_start(line, 80) + "'");
    }
    if (readings.size() == kMaxClockReadings) {
      return file.error("expected at most " + std::to_string(kMaxClockReadings) + " lines");
    }
    if (!readings.empty() &&
        (reading->monotonic < readings.back().monotonic ||
         reading->suspended + ClockChanges::kLeast < readings.back().suspended)) {
      return file.error("expected times that do not fall from line to line, found '" +
                        printable_start(line, 80) + "'");
    }
    readings.push_back(*reading);
  }
  if (!file.status()) return file.status().error();
  if (readings.empty()) return Error{file.name() + ": expected a line at least, found none"};
  return ClockLog(std::move(readings));
}

Result<ClockLog> read_clock_log(const std::filesystem::path& path) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_clock_log(*file);
}

}  // namespace zenith
