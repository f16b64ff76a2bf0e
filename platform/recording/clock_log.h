#pragma once
// clock.csv of a recording: how the clock of its stamps lay against the wall clock.
//
//   #monotonic [ns],suspended [ns],wall minus monotonic [ns],synchronised
//   1211000000,0,1780000000123456789,1        at the start, at each change, at the end
//
// Two computers' recordings are put on one clock by it:
//
//   wall time = stamp + suspended(stamp) + (wall - suspended) of the last synchronised line
//
// The kernel slews both clocks alike, so their distance changes by steps alone: when the wall clock
// is set, or the board has slept. Time asleep is time that passed. A step is a correction, so that
// what the clock says after it holds for all of the recording; the last line that was synchronised
// is the best to trust, and without any the last one.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/clock_reading.h"
#include "platform/linux/input_file.h"

namespace zenith {

inline constexpr std::size_t kMaxClockReadings = 100'000;
inline constexpr const char* kClockLogHeader =
    "#monotonic [ns],suspended [ns],wall minus monotonic [ns],synchronised\n";

// Which readings are worth a line.
class ClockChanges {
 public:
  static constexpr Duration kLeast = {1'000'000};

  // Whether it is the first, or differs from the last one that was worth it.
  bool is_change(const ClockReading& reading);

 private:
  std::optional<ClockReading> last_;
};

class ClockLog {
 public:
  // One at least; their monotonic times do not fall.
  explicit ClockLog(std::vector<ClockReading> readings);

  // What is to be added to a stamp to make it wall time. It never falls from stamp to stamp.
  Duration offset(Time stamp) const;
  bool synchronised() const;
  // By which the wall clock was set while it recorded, first to last; 0 when it was not set.
  Duration stepped() const;
  Duration slept() const;  // while it recorded

  const std::vector<ClockReading>& readings() const { return readings_; }

 private:
  std::vector<ClockReading> readings_;
  ClockReading trusted_;
};

// With its end.
std::string format_clock_reading(const ClockReading& reading);

Result<ClockLog> parse_clock_log(InputLines& lines);
Result<ClockLog> read_clock_log(const std::filesystem::path& path);

}  // namespace zenith
