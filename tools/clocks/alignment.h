#pragma once
// Recordings of several robots on one clock. Each is stamped by its own computer's monotonic clock,
// which begins at that computer's start; clock.csv (platform/recording/clock_log.h) says where it
// lies against the wall clock.
//
//   every one has clock.csv, or wall time as stamps   all on wall time
//   else                                              as recorded, as far as can be seen one clock
//
// A person may have the recordings begin together instead, and may state offsets.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/clock_log.h"

namespace zenith::tools {

enum class AlignBy {
  kClocks,    // clock.csv where there is one, see above
  kStart,     // the first frames of all at the same time
  kRecorded,  // stamps as they are
};

struct AlignOptions {
  AlignBy by = AlignBy::kClocks;
  std::map<std::string, double> stated_s;  // by robot: added to its stamps beside all else
};

// "robot-2=12.5", seconds.
Result<std::pair<std::string, double>> parse_stated_offset(const std::string& text);

struct RecordedSpan {
  std::string name;
  Time first;  // frame
  Time last;
  std::optional<ClockLog> clock;
};

// What is added to a recording's stamps: from each of these stamps on, in their order.
class ClockShift {
 public:
  struct Piece {
    Time from;
    Duration offset;
  };
  ClockShift() = default;
  explicit ClockShift(Duration offset) : pieces_{{Time{}, offset}} {}

  // Offsets do not fall: time asleep is added.
  void add(Time from, Duration offset) { pieces_.push_back({from, offset}); }
  void move(Duration by) {
    for (Piece& piece : pieces_) piece.offset = piece.offset + by;
  }
  Time of(Time stamp) const;
  bool is_none() const;
  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  std::vector<Piece> pieces_ = {{Time{}, Duration{}}};
};

struct Alignment {
  std::vector<ClockShift> shifts;  // one for each
  bool wall = false;               // stamps are wall time now
  // Whether any two have no time in common.
  bool disjoint = false;
  // Disjoint although nothing says that they were recorded at different times.
  bool unexplained = false;
  std::vector<std::string> notes;     // how, and what they share: for a person
  std::vector<std::string> warnings;  // what may be wrong with it, and what to do
};

// An error: a stated robot is none of these, or stamps would be beyond what a clock has.
Result<Alignment> align(const std::vector<RecordedSpan>& recordings, const AlignOptions& options);

}  // namespace zenith::tools
